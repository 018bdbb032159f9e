"""What the rig file says would have been recorded: quick simulated repeats of a condition.

The transfer functions are those of `noise.diagnosis.simulated.transfer_functions`, applied to the
simulated torque, so a repeat costs a few milliseconds. A rig file that lists effects beyond
friction and drive is run by `noise.diagnosis.simulated.replicates` instead, which knows all of
them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import resample_poly

from noise.diagnosis.gap.scatter import Scatter, scattered
from noise.diagnosis.simulated.chain_run import fine_rate, sensed
from noise.diagnosis.simulated.replicates import replicates
from noise.diagnosis.simulated.transfer_functions import predict, shift_clamp_mode
from sim.bushing import lumped_bushing
from sim.effects import EFFECTS
from sim.effects.effect import activated
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from models.condition import Condition
    from models.recording import Recording
    from models.rig import Rig
    from models.transfer_functions.transfer_function import TransferFunction
    from sim.effects.effect import Effect

__all__ = ["nominal_recordings"]

_SETTLING = 0.35
"""Simulated before a recording begins [s]."""

_RUNNING_OUT = 0.12
"""Simulated after a recording ends [s]."""

_FADE = 0.1
"""In which a torque fades in and out [s], outside of the recording."""


def nominal_recordings(
    rig: Rig,
    condition: Condition,
    found_ways: Mapping[str, TransferFunction],
    *,
    rate: float,
    seconds: float,
    seeds: Sequence[int],
    scatter: Scatter | None = None,
    library: Mapping[str, Effect] | None = None,
) -> list[Recording]:
    """Simulate repeats of a run of the rig as its file has it.

    Parameters
    ----------
    rig : Rig
    condition : Condition
        Speed, interference and support stiffness; all must be known.
    found_ways : mapping of str to TransferFunction
        As `torque_transfer_functions` gives them for this condition.
    rate, seconds : float
        [Hz], [s]
    seeds : sequence of int
        One a repeat.
    scatter : Scatter, optional
    library : mapping of str to Effect, optional
        Effects that the rig's can be found among.

    Returns
    -------
    list of Recording
    """
    effects = activated(rig.effects, library or EFFECTS)
    if any(e.effect.force or e.effect.chain or e.effect.sensors for e in effects):
        return replicates(
            rig, condition, rate=rate, seconds=seconds, seeds=seeds, scatter=scatter,
            library=library,
        )  # fmt: skip
    assert condition.speed is not None
    assert condition.interference is not None
    assert condition.support_stiffness is not None
    scatter = scatter or Scatter()
    fine = fine_rate(rate)
    decimation = round(fine / rate)
    before = round(_SETTLING * rate)
    kept = slice(before, before + round(seconds * rate))
    n = (kept.stop + round(_RUNNING_OUT * rate)) * decimation
    at = (condition.interference, condition.support_stiffness)
    bushing = lumped_bushing(rig, *at)
    recordings = []
    for seed in seeds:
        rng = np.random.default_rng(seed)
        once = scattered(rig, scatter, rng)
        motion = simulate_motion(
            once,
            ConstantSpeed(condition.speed * float(np.exp(scatter.structure * rng.normal()))),
            interference=condition.interference,
            support_stiffness=condition.support_stiffness,
            seconds=n / fine,
            rate=fine,
            effects=effects,
            rng=rng,
        )
        torque, angle = (
            resample_poly(x, 1, decimation, padtype="line")
            for x in (motion.torque, motion.shaft_angle)
        )
        faded = torque[kept].mean() + _faded(torque - torque[kept].mean(), rate)
        lumped = lumped_bushing(once, *at)
        outputs = {
            name: predict(faded, rate, shift_clamp_mode(found_ways[name], bushing, lumped))[kept]
            for name in ("acceleration", "pressure")
        }
        signals = {
            "torque": torque[kept],
            **outputs,
            "angle": angle[kept] - angle[before],
        }
        recordings.append(sensed(signals, rate, condition, rng, scatter))
    return recordings


def _faded(signal: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    """Fade in and out.

    Errors of a measured response have it ring before and after whatever is sudden, for as long as
    its lines are fine. What rings on from before a recording must be in it, but the start from rest
    and the end of the simulation must not.
    """
    n = round(_FADE * rate)
    slope = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, n))
    gain = np.ones(signal.size)
    gain[:n], gain[-n:] = slope, slope[::-1]
    return np.asarray(signal * gain)
