"""Simulated repeats of what was recorded: same condition, rate and length, rigs that scatter."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from noise.diagnosis.gap.scatter import Scatter, scattered
from sim.acquisition import Acquisition
from sim.run import simulate

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from models.condition import Condition
    from models.recording import Recording
    from models.rig import Rig
    from sim.effects.effect import Effect

__all__ = ["replicates"]


def replicates(
    rig: Rig,
    condition: Condition,
    *,
    rate: float,
    seconds: float,
    seeds: Sequence[int],
    scatter: Scatter | None = None,
    library: Mapping[str, Effect] | None = None,
) -> list[Recording]:
    """Simulate repeats of a run.

    Parameters
    ----------
    rig : Rig
    condition : Condition
        Speed, interference and support stiffness; all must be known.
    rate, seconds : float
        [Hz], [s]
    seeds : sequence of int
        One a repeat.
    scatter : Scatter, optional
        By default that of `Scatter`.
    library : mapping of str to Effect, optional
        Effects that the rig's can be found among.

    Returns
    -------
    list of Recording

    Examples
    --------
    >>> from models.condition import Condition
    >>> from models.rig_files.rig_file import load_material_rig
    >>> condition = Condition(speed=2.5, interference=0.279e-3, support_stiffness=2214.0)
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> runs = replicates(rig, condition, rate=30e3, seconds=0.1, seeds=(0, 1))
    >>> [run.samples.shape for run in runs]
    [(4, 3000), (4, 3000)]
    """
    scatter = scatter or Scatter()
    return [_repeat(rig, condition, rate, seconds, seed, scatter, library) for seed in seeds]


def _repeat(
    rig: Rig,
    condition: Condition,
    rate: float,
    seconds: float,
    seed: int,
    scatter: Scatter,
    library: Mapping[str, Effect] | None,
) -> Recording:
    assert condition.speed is not None
    assert condition.interference is not None
    assert condition.support_stiffness is not None
    rng = np.random.default_rng(seed)
    speed = condition.speed * float(np.exp(scatter.structure * rng.standard_normal()))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what measured responses lack was said once already
        run = simulate(
            scattered(rig, scatter, rng),
            speed,
            interference=condition.interference,
            support_stiffness=condition.support_stiffness,
            seconds=seconds,
            acquisition=Acquisition(rate=rate),
            library=library,
            rng=rng,
        )
    recording = run.recording
    gain = 1.0 + scatter.gain * rng.standard_normal((recording.samples.shape[0], 1))
    gain[[kind == "angle" for kind in (c.kind for c in recording.channels)]] = 1.0
    return replace(recording, samples=recording.samples * gain)
