"""Speed, interference and support that a recording does not state, taken from angle and torque.

The speed is the angle's. The interference is that of the rig's fits whose kinetic torque the mean
torque is near to, where it is near to no other. The support is that with which the bushing's
surface sticks to the shaft. What is not clear is not taken. Without an angle the surface's speed
while it sticks is proposed and not taken: a stiffness that is off changes it as much.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from models.condition import FIXED, Condition
from models.errors import ParameterError
from models.recording import Recording
from models.rig import Rig
from noise.diagnosis.preparation.measured_speed import measured_speed
from noise.diagnosis.unstated.sidecar import sidecar_request
from noise.diagnosis.unstated.sticking import Sticking, sticking
from noise.recordings.logged_speed import as_logged
from sim.bushing import lumped_bushing

_NEAR, _FAR = (-0.2, 0.3), (-0.35, 0.5)
"""Logarithm of mean over kinetic torque [-]: of a fit that it can be, and of all that it can be;
assumed."""

_SWINGING = 0.05
"""Standard deviation of a torque over its mean from which something sticks and slips [-];
assumed."""

_STICKS = {"stated": 0.3, "proposed": 0.12}
"""By how much a surface that sticks may seem to leave the shaft [-], by how its speed is known;
assumed."""

_CLEARLY = 2.5, 0.12
"""How many times, and by how much, another support must be further off [-]; assumed."""

_Told = tuple["Condition", list[str]]


class _UnclearError(Exception):
    """What is not stated is not told either; the message says why."""

    def __init__(self, why: str, proposed: Condition | None = None) -> None:
        super().__init__(why)
        self.proposed = proposed


def with_told_conditions(recording: Recording, rig: Rig) -> Recording:
    """Fill in what a recording's condition leaves out.

    Parameters
    ----------
    recording : Recording
        Calibrated, named as its file.
    rig : Rig

    Returns
    -------
    Recording
        With speed, interference and support stiffness, and a note on each that was taken.

    Raises
    ------
    ParameterError
        Something is not stated, and neither angle nor torque tells it; the message holds the
        sidecar to write.

    Examples
    --------
    >>> from models.condition import Condition
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> run = simulate(rig, 1.0, interference=0.279e-3, support_stiffness=3745.0, seconds=0.4)
    >>> told = with_told_conditions(replace(run.recording, condition=Condition(speed=1.0)), rig)
    >>> told.condition.interference, told.condition.support_stiffness
    (0.000279, 3745.0)
    >>> told.notes[0]
    'interference taken as 0.279 mm: the mean torque of ... N m fits none of the others'
    """
    at, notes = recording.condition, []
    try:
        for step in (_by_rig, _by_angle, _by_mean_torque, _by_sticking):
            at, said = step(recording, rig, at)
            notes += said
    except _UnclearError as unclear:
        lacking = ", ".join(name for name, value in _needed(at) if not value)
        interferences = [fit.interference for fit in rig.fits]
        filled = replace(recording, condition=unclear.proposed or at)
        request = sidecar_request(filled, interferences, supports_of(rig))
        raise ParameterError(f"states no {lacking}, and {unclear}; {request}") from None
    return replace(recording, condition=at, notes=(*recording.notes, *notes))


def supports_of(rig: Rig) -> list[float]:
    """Return the supports that a rig file knows.

    Parameters
    ----------
    rig : Rig

    Returns
    -------
    list of float
        Stiffnesses [Nm/rad] or `models.condition.FIXED`: those whose responses were measured, or
        else those at which damping is given.
    """
    known = [entry.support_stiffness for entry in rig.measured]
    return sorted(set(known) or {support for fit in rig.fits for support in fit.damping})


def _needed(at: Condition) -> tuple[tuple[str, float | None], ...]:
    return (
        ("speed_rad_s", at.speed),
        ("interference_mm", at.interference),
        ("support_stiffness_Nm_rad", at.support_stiffness),
    )


def _by_rig(_: Recording, rig: Rig, at: Condition) -> _Told:
    """Take what there is only one of."""
    supports = supports_of(rig)
    if at.interference is None and len(rig.fits) == 1:
        at = replace(at, interference=rig.fits[0].interference)
    if at.support_stiffness is None and len(supports) == 1:
        at = replace(at, support_stiffness=supports[0])
    return at, []


def _by_angle(recording: Recording, _: Rig, at: Condition) -> _Told:
    row = recording.first("angle")
    if at.speed or row is None:
        return at, []
    angle = recording.samples[row]
    measured = measured_speed(angle[angle.size // 2 :], recording.rate)  # a start lies before
    speed = as_logged(measured, None)
    if not speed:
        return at, []
    return replace(at, speed=speed), [f"speed taken as {speed:g} rad/s: the angle's"]


def _by_mean_torque(recording: Recording, rig: Rig, at: Condition) -> _Told:
    if at.interference is not None:
        return at, []
    torque = _torque(recording)
    mean = abs(float(torque.mean()))
    away = {
        fit.interference: float(np.log((mean + 1e-12) / fit.kinetic_torque)) for fit in rig.fits
    }
    near = [fit for fit, by in away.items() if _NEAR[0] < by < _NEAR[1]]
    possible = [fit for fit, by in away.items() if _FAR[0] < by < _FAR[1]]
    if not len(near) == len(possible) == 1:
        each = ", ".join(f"{_mm(f.interference)} {f.kinetic_torque:.3g}" for f in rig.fits)
        fits = "several fits" if len(possible) > 1 else "no fit clearly"
        raise _UnclearError(f"the mean torque of {mean:.3g} N m fits {fits} ({each} N m)")
    found = replace(at, interference=near[0])
    if at.speed and _swings(torque):  # with a fixed clamp each stiffness has a speed that would do
        off = {
            fit.interference: min(_sticking(recording, rig, found, fit.interference, k).off
                                  for k in _supports(rig, at))
            for fit in rig.fits
        }  # fmt: skip
        other = min(off, key=lambda fit: off[fit])
        if other != near[0] and _CLEARLY[0] * off[other] < off[near[0]]:
            raise _UnclearError(
                f"the mean torque is that of {_mm(near[0])}, its course that of {_mm(other)}"
            )
    return found, [
        f"interference taken as {_mm(near[0])}: the mean torque of {mean:.3g} N m fits none of the "
        "others"
    ]


def _by_sticking(recording: Recording, rig: Rig, at: Condition) -> _Told:
    if at.speed and at.support_stiffness is not None:
        return at, []
    torque = _torque(recording)
    if not _swings(torque):
        raise _UnclearError("the torque does not stick and slip, which would tell")
    assert at.interference is not None  # `_by_mean_torque` told it
    found = {s: _sticking(recording, rig, at, at.interference, s) for s in _supports(rig, at)}
    support = min(found, key=lambda s: found[s].off)
    best = found[support]
    others = [one.off for s, one in found.items() if s != support]
    clear = all(off > max(_CLEARLY[0] * best.off, best.off + _CLEARLY[1]) for off in others)
    if best.off > _STICKS["stated" if at.speed else "proposed"] or not clear:
        raise _UnclearError("the torque does not tell clearly when the surface sticks")
    if not at.speed:
        raise _UnclearError(
            f"the torque says {best.speed:.2g} rad/s if the rig file's stiffness is right",
            replace(at, speed=float(f"{best.speed:.2g}"), support_stiffness=support),
        )
    words = "the clamp bolted down" if support == FIXED else f"{support:g} Nm/rad"
    said = f"support taken as {words}: only with it does the surface stick, by the torque"
    return replace(at, support_stiffness=support), [said]


def _torque(recording: Recording) -> NDArray[np.float64]:
    row = recording.first("torque")
    if row is None:
        raise _UnclearError("there is no torque that would tell")
    return np.asarray(recording.samples[row], dtype=np.float64)


def _swings(torque: NDArray[np.float64]) -> bool:
    return float(torque.std()) > _SWINGING * abs(float(torque.mean()))


def _supports(rig: Rig, at: Condition) -> list[float]:
    return supports_of(rig) if at.support_stiffness is None else [at.support_stiffness]


def _sticking(
    recording: Recording, rig: Rig, at: Condition, interference: float, support: float
) -> Sticking:
    bushing = lumped_bushing(rig, interference, support)
    return sticking(_torque(recording), recording.rate, bushing, at.speed or None)


def _mm(interference: float) -> str:
    return f"{1e3 * interference:.4g} mm"
