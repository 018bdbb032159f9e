"""Groups of rows of the table, in their order; why those that are missed are is in ``why.toml``."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import lru_cache, partial
from importlib import resources

from noise.thesis import (
    acquisition,
    anchors,
    calibrations,
    critical_velocities,
    damping,
    heat,
    misprints,
    modes,
    natural_rubber,
    pressure,
    slip_frequencies,
    stiffness,
    torques,
    waveforms,
)
from noise.thesis.row import Row


@lru_cache(maxsize=1)
def reasons() -> dict[tuple[str, str], str]:
    """Return why measured numbers are missed, by item and condition of the row.

    Examples
    --------
    >>> reasons()["v_crit1", "0.178 mm, 2214 Nm/rad"][:20]
    "The torque's drop at"
    """
    text = (resources.files("noise.thesis") / "why.toml").read_text(encoding="utf-8")
    return {tuple(row): one["text"] for one in tomllib.loads(text)["why"] for row in one["rows"]}


GROUPS: tuple[Callable[[], Iterable[Row]], ...] = (
    calibrations.potentiometer,
    calibrations.torque_cell,
    calibrations.transducers,
    acquisition.converter,
    acquisition.lengths,
    stiffness.shaft,
    stiffness.beams,
    stiffness.series,
    modes.torsional_modes,
    modes.beam_modes,
    *(partial(anchors.fitted, kind) for kind in anchors.KINDS),
    anchors.shipped,
    heat.heating,
    misprints.misprints,
    modes.squeal,
    damping.critical,
    damping.measured,
    critical_velocities.simulated,
    *(partial(critical_velocities.transitions, case) for case in critical_velocities.MEASURED),
    critical_velocities.contradiction,
    waveforms.regimes,
    waveforms.amplitudes,
    waveforms.patterns,
    torques.peaks,
    torques.first_slip,
    torques.friction,
    torques.silicone,
    pressure.torques,
    pressure.stiffness,
    natural_rubber.natural_rubber,
    torques.creak,
    slip_frequencies.at_fixed_clamp,
    *(partial(slip_frequencies.bounded, *where) for where in slip_frequencies.BOUNDED),
    slip_frequencies.rising,
    slip_frequencies.harmonics,
    slip_frequencies.constant,
    slip_frequencies.falling_with_interference,
)
"""All groups, in the order of the table."""


def thesis_rows(groups: Iterable[Callable[[], Iterable[Row]]]) -> list[Row]:
    """Compute the rows of groups; those that are missed say why.

    Examples
    --------
    >>> [row.verdict for row in thesis_rows([misprints.misprints])][:2]
    ['misprint', 'misprint']
    """
    return [
        replace(row, why=reasons().get((row.item, row.condition), ""))
        for group in groups
        for row in group()
    ]
