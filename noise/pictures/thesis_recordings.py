"""What the thesis's figures of recordings show: channels over time, spectra, torque over speed.

Figures 5.1, 5.4 to 5.9, 5.13 and 5.19 to 5.24. Their curves are lost; what is here is simulated and
recorded by the modelled sensors, with the lines and the speeds that the thesis names. Recordings
are of the materials as they are shipped, irregular as they state, torques over speed of their
constant version. Each function returns rows of panels.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from features.kernels.spectra import autospectrum
from models.condition import FIXED
from models.drawing import BLUE, levels
from models.rig_file import load_material_rig
from noise.pictures.axes import MODEL_COLOURS
from noise.pictures.channel_kinds import KINDS
from noise.pictures.measured import FIRST_MODE, lines_at
from noise.pictures.model_traces import SHOWN
from noise.pictures.panels import Curve, Panel
from noise.pictures.sweep import sweep_torque
from noise.pictures.titles import support_words
from noise.thesis.runs import CALIBRATED, LONG, SHORT, THESIS, Case, rig_of
from sim.run import simulate

if TYPE_CHECKING:
    from collections.abc import Mapping

    from models.recording import Recording

__all__ = [
    "FRICTION_TYPES", "channels", "friction_types", "spectra_by_support", "steady_sliding",
    "torque_over_speed",
]  # fmt: skip

FRICTION_TYPES = {
    "(a) stick-slip": Case(1.0, 0.279, FIXED),
    "(b) with feedback": Case(1.0, 0.279, SHORT),
    "(c) triangular": Case(4.3, 0.178, LONG),
    "(d) harmonic": Case(7.9, 0.279, SHORT),
}
"""Of Figures 5.1 and 5.2."""

_TORQUE_SPAN, _WHOLE_SPAN = (0.0, 2e3), (20.0, 15e3)
"""Of the spectra of the torque alone, linear, and of all channels, logarithmic [Hz]."""

_DYNAMIC_RANGE = 90.0
"""Of a spectrum below its peak, at most [dB]."""


@lru_cache(maxsize=4)
def _recording(material: str, case: Case) -> Recording:
    run = simulate(
        load_material_rig(material), case.speed,
        interference=case.interference, support_stiffness=case.support_stiffness,
    )  # fmt: skip
    return run.recording


def _loudest(recording: Recording) -> slice:
    """Return the part that is shown: about the largest acceleration, as slips may be far apart."""
    size = round(SHOWN * recording.rate)
    peak = int(np.abs(recording["acceleration"]).argmax())
    first = min(max(0, peak - size // 4), recording.samples.shape[1] - size)
    return slice(first, first + size)


def _history(material: str, case: Case, name: str, title: str, colour: str = "") -> Panel:
    recording, kind = _recording(material, case), KINDS[name]
    shown = recording[name][_loudest(recording)]
    curve = Curve(
        1e3 * np.arange(shown.size, dtype=np.float64) / recording.rate,
        shown,
        "",
        colour or kind.colour,
    )
    return Panel(
        title, "Time [ms]", f"{kind.name} [{kind.unit}]", [curve], span=(0.0, 1e3 * SHOWN),
        least=kind.least_swing, from_zero=name == "torque",
    )  # fmt: skip


def _spectrum(
    material: str, case: Case, name: str, title: str, marks: Mapping[str, float], *, whole: bool
) -> Panel:
    recording, kind = _recording(material, case), KINDS[name]
    spectrum = autospectrum(recording[name], recording.rate)
    low, high = span = _WHOLE_SPAN if whole else _TORQUE_SPAN
    shown = (spectrum.frequency >= low) & (spectrum.frequency <= high)
    level = levels(spectrum.density[shown], kind.reference)
    curve = Curve(spectrum.frequency[shown], level, "", kind.colour)
    named = {f"{line:.4g} Hz": line for line in _lines(case)} | dict(marks)
    return Panel(
        title, "Frequency [Hz]", f"{kind.name}\n[dB re {kind.density}]", [curve], named,
        span=span, log_frequency=whole, most=_DYNAMIC_RANGE,
    )  # fmt: skip


def _lines(case: Case) -> list[float]:
    return lines_at(case.interference_mm, case.support_stiffness, case.speed)


def _modes(support: float) -> dict[str, float]:
    if support not in FIRST_MODE:
        return {}
    return {f"first torsional mode, {FIRST_MODE[support]:g} Hz": FIRST_MODE[support]}


def friction_types() -> list[list[Panel]]:
    """Torque over time of the four types, in two models (Figure 5.1)."""
    return [
        [
            _history(material, case, "torque", f"{name}: {case}; {model}", MODEL_COLOURS[model])
            for model, material in (("constant torque", THESIS), ("calibrated", CALIBRATED))
        ]
        for name, case in FRICTION_TYPES.items()
    ]


def channels(
    material: str,
    case: Case,
    names: tuple[str, ...] = ("torque",),
    marks: Mapping[str, float] | None = None,
) -> list[list[Panel]]:
    """Channels over time and their autospectra, a row each (Figures 5.7 to 5.9, 5.19, 5.21 on).

    Parameters
    ----------
    material : str
    case : Case
    names : tuple of str
        Of the channels; the spectrum of the torque alone is shown as far as it reaches.
    marks : mapping of str to float, optional
        Frequencies that the thesis names beside those of `noise.pictures.measured` [Hz].

    Returns
    -------
    list of list of Panel

    Examples
    --------
    >>> (torque, spectrum), = channels("PDMS", Case(1.0, 0.381))
    >>> torque.up, list(spectrum.marks)
    ('Torque [Nm]', ['first torsional mode, 250 Hz'])
    """
    named = _modes(case.support_stiffness) | dict(marks or {})
    whole = len(names) > 1
    return [
        [
            _history(material, case, name, f"({'abc'[i]}) {KINDS[name].name}"),
            _spectrum(
                material, case, name, f"({'abcdef'[i + len(names)]}) autospectrum", named,
                whole=whole,
            ),
        ]
        for i, name in enumerate(names)
    ]  # fmt: skip


def steady_sliding(material: str, case: Case) -> list[list[Panel]]:
    """Torque and acceleration over time (Figure 5.4)."""
    return [[_history(material, case, name, "")] for name in ("torque", "acceleration")]


def spectra_by_support(material: str, speed: float, interference_mm: float) -> list[list[Panel]]:
    """Autospectra of the torque with long and with short beams (Figure 5.20).

    Parameters
    ----------
    material : str
    speed : float
        [rad/s]
    interference_mm : float
        [mm]
    """
    row = []
    for letter, support in (("(a)", LONG), ("(b)", SHORT)):
        case, title = Case(speed, interference_mm, support), f"{letter} {support_words(support)}"
        row.append(_spectrum(material, case, "torque", title, _modes(support), whole=False))
    return [row]


def torque_over_speed(
    material: str,
    interference_mm: float,
    fastest: Mapping[float, float],
    *,
    rise: float = 1.0,
    slowest: float = 1.0,
) -> list[list[Panel]]:
    """Mean, lowest and highest torque over speed, a panel a support (Figures 5.5, 5.6 and 5.13).

    Parameters
    ----------
    material : str
    interference_mm : float
        [mm]
    fastest : mapping of float to float
        Highest speed of the thesis [rad/s] by support [Nm/rad].
    rise : float
        Over the thesis's range, of the torque at its end over that at its beginning [-].
    slowest : float
        Where its range begins [rad/s].

    Returns
    -------
    list of list of Panel
        The rise is drawn from the first computed torque, as the thesis's levels are lost.

    Examples
    --------
    >>> (panel,), = torque_over_speed("PDMS", 0.254, {2214.0: 17.0}, rise=3.0, slowest=0.25)
    >>> [curve.label for curve in panel.curves]
    ['mean', 'lowest and highest', '', 'thesis: 3 times, from our first torque on']
    """
    speeds = np.geomspace(slowest, max(fastest.values()), 25)
    swept = sweep_torque(
        rig_of(material), speeds,
        interference=1e-3 * interference_mm, support_stiffness=tuple(fastest),
    )  # fmt: skip
    row = []
    for i, (support, last) in enumerate(fastest.items()):
        first = float(swept.mean[i, 0])
        label = f"{'constant' if rise == 1.0 else f'{rise:g} times'}, from our first torque on"
        curves = [
            Curve(speeds, swept.mean[i], "mean", BLUE),
            Curve(speeds, swept.low[i], "lowest and highest", BLUE, ":"),
            Curve(speeds, swept.high[i], "", BLUE, ":"),
            Curve.published([slowest, last], [first, rise * first], label, "s--"),
        ]
        title = f"({'ab'[i]}) {support_words(support)}"
        row.append(
            Panel(title, "Speed of the shaft [rad/s]", "Torque [Nm]", curves, from_zero=True)
        )
    return [row]
