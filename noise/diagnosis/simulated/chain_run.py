"""Runs of a rig through impulse responses that are given: with any effects, quickly, often.

`sim.run.simulate` makes the responses anew from the rig; the diagnosis runs one rig and its
variations hundreds of times, and has the responses measured. The stages are those of
`sim.pipeline`, the timing `sim.timing.DIAGNOSIS`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from models.radiation.impulse_responses import ImpulseResponses
from models.radiation.rig_response import impulse_responses
from models.recording import Channel, Recording
from models.transfer_functions.impulse_response import impulse_response
from noise.diagnosis.gap.scatter import Scatter, perturb_run
from sim.acquisition import Acquisition, decimate
from sim.chain import changed_chain
from sim.pipeline import Plan, apply_sensor_effects, radiate_motion, run_motion, sensor_signals
from sim.shaft import ConstantSpeed
from sim.timing import DIAGNOSIS

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from models.condition import Condition, KnownCondition
    from models.rig import Rig
    from models.transfer_functions.transfer_function import TransferFunction
    from sim.effects.effect import ActiveEffect

__all__ = ["CHANNELS", "chain_of", "plan_repeat", "record", "run_signals"]

CHANNELS = ("torque", "acceleration", "pressure", "angle")

_LONGEST = 0.25
"""Impulse responses are followed so long [s]."""


def chain_of(
    rig: Rig,
    interference: float,
    support_stiffness: float,
    transfer_functions: Mapping[str, TransferFunction],
    rate: float,
    *,
    blows: bool,
) -> ImpulseResponses:
    """Return the impulse responses of a rig; those of pulses in the anchors only if asked for."""
    n = int(_LONGEST * rate)
    torque_to = {name: impulse_response(h, rate, n) for name, h in transfer_functions.items()}
    struck = sounding = np.zeros(1)
    if blows:
        modelled = impulse_responses(rig, interference, support_stiffness, rate)
        struck, sounding = modelled.pulse_to_acceleration, modelled.pulse_to_pressure
    return ImpulseResponses(
        rate, torque_to["acceleration"], torque_to["pressure"], struck, sounding
    )


def plan_repeat(
    rig: Rig,
    condition: KnownCondition,
    effects: Sequence[ActiveEffect],
    *,
    rate: float,
    seconds: float,
) -> Plan:
    """Plan a run at a condition.

    Parameters
    ----------
    rig : Rig
    condition : KnownCondition
    effects : sequence of ActiveEffect
    rate : float
        Of motion and sound [Hz].
    seconds : float
        Of the recording [s].

    Returns
    -------
    Plan

    Examples
    --------
    >>> from models.condition import KnownCondition
    >>> from models.rig_files.rig_file import load_material_rig
    >>> at = KnownCondition(5.0, 0.279e-3, 2214.0)
    >>> plan = plan_repeat(load_material_rig("PDMS"), at, (), rate=DIAGNOSIS.rate(30e3), seconds=1)
    >>> plan.rate, plan.n_settling, plan.n_kept
    (90000.0, 31500, 90000)
    """
    return Plan(
        rig=rig,
        shaft=ConstantSpeed(condition.speed),
        interference=condition.interference,
        support_stiffness=condition.support_stiffness,
        effects=effects,
        rate=rate,
        n_settling=round(DIAGNOSIS.settling * rate),
        n_kept=round(seconds * rate),
    )


def run_signals(
    rig: Rig,
    condition: KnownCondition,
    effects: Sequence[ActiveEffect],
    chain: ImpulseResponses,
    seconds: float,
    rng: np.random.Generator,
    *,
    chain_seed: int = 0,
    scatter: Scatter | None = None,
) -> dict[str, NDArray[np.float64]]:
    """Run a rig as one of its runs finds it.

    Parameters
    ----------
    rig : Rig
    condition : KnownCondition
    effects : sequence of ActiveEffect
    chain : ImpulseResponses
        Responses without effects; their rate is that of the signals.
    seconds : float
        [s]
    rng : numpy.random.Generator
    chain_seed : int
        Of effects that change the chain by chance: one structure for all runs.
    scatter : Scatter, optional

    Returns
    -------
    dict of str to ndarray
        By `CHANNELS`, without noise.

    Raises
    ------
    ParameterError
        The rig cannot be simulated.
    """
    once, at = perturb_run(rig, condition, scatter or Scatter(), rng, support=True)
    plan = plan_repeat(once, at, effects, rate=chain.rate, seconds=seconds)
    motion = run_motion(plan, rng)
    changed = changed_chain(chain, effects, np.random.default_rng(chain_seed))
    sound = radiate_motion(motion, changed, effects)
    signals = sensor_signals(motion, sound, plan.n_settling)
    return apply_sensor_effects(signals, effects, chain.rate, rng)


def record(
    signals: Mapping[str, NDArray[np.float64]],
    rate: float,
    condition: Condition,
    rng: np.random.Generator,
    scatter: Scatter | None = None,
    *,
    decimation: int = 1,
) -> Recording:
    """Sample signals by good instruments: gains that scatter, a little white noise.

    Parameters
    ----------
    signals : mapping of str to ndarray, shape (n,)
        By `CHANNELS`, at `decimation` times the sampling rate.
    rate : float
        Sampling rate [Hz].
    condition : Condition
    rng : numpy.random.Generator
        Of gains and noise.
    scatter : Scatter, optional
        Of the gains.
    decimation : int

    Returns
    -------
    Recording
    """
    scatter = scatter or Scatter()
    levels = Acquisition().noise
    rows = []
    for name in CHANNELS:
        x = decimate(signals[name], decimation)
        gain = 1.0 if name == "angle" else 1.0 + scatter.gain * rng.normal()
        rows.append(gain * x + levels[name] * rng.standard_normal(x.size))
    return Recording(np.stack(rows), rate, tuple(Channel(name) for name in CHANNELS), condition)
