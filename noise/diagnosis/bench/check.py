"""Check of a bench: units, signs, channels, conditions and material of its recordings.

The check comes before the diagnosis, because the posterior of causes was trained on correct benches
and names a cause for any input. A bench with a finding gets no cause.

Material and fit determine the contact's torque, and no effect halves it at every condition. Another
material is reported if a shipped one predicts mean, swing and frequency of the torque in every
recording and the rig file does not.

If the contact slides smoothly, the torque does not excite acceleration and sound, and their units
are not checked. The stated speed and its sign are compared with the angle.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from models.errors import BushingNoiseError, ParameterError
from models.recording import Recording
from models.rig import Rig
from models.rig_file import load_material_rig, material_names
from noise.base.arrays import Array
from noise.diagnosis.bench.channels import (
    SWINGING,
    Levels,
    factor_words,
    levels_of,
    swapped_outputs,
    turned_channels,
    unit_of,
    wrong_units,
)
from noise.diagnosis.simulated.repeats import nominal_repeats
from noise.diagnosis.simulated.transfer_functions import TransferFunctionCache
from sim.effects.effect import Effect

if TYPE_CHECKING:
    from noise.diagnosis.case import Case


_SPEED = 0.2
"""Largest difference of logarithms between the stated speed and the angle's; a dial errs by 3 %,
and fluctuations average out [-]; assumed."""

_STILL = 0.05
"""Share of the stated speed below which the angle counts as constant [-]; assumed."""

LEAST_RATE = 8e3
"""Least sampling rate [Hz], which covers the cycle's harmonics up to 3 kHz; assumed."""


def refuse_unusable(recording: Recording, shortest: float) -> None:
    """Refuse a recording that cannot be compared with a rig.

    Parameters
    ----------
    recording : Recording
    shortest : float
        Least duration [s].

    Raises
    ------
    ParameterError
        The recording is not in physical units, its sampling rate is too low or it is too short.
    """
    if not recording.calibrated:
        raise ParameterError(
            "is not in physical units; state unit and scale of each channel, speed, interference "
            'and support in a sidecar (the same name with .json), with "calibrated": true'
        )
    if recording.rate < LEAST_RATE:
        raise ParameterError(f"is sampled at {recording.rate:g} Hz; {LEAST_RATE:g} at least")
    if recording.duration < shortest:
        raise ParameterError(f"lasts {recording.duration:.3g} s; {shortest:.3g} s at least")


def wrong_speed(levels: Sequence[Levels]) -> str:
    """Return a finding if the angle's speed differs from the stated one; otherwise empty."""
    speeds = np.array([(one.turned, one.speed) for one in levels if one.turned is not None])
    if not speeds.size:
        return ""
    turned, stated = speeds.T
    ratios = turned / stated
    if words := speed_words(float(np.median(ratios)), float(np.median(np.abs(stated)))):
        return words
    off = np.abs(np.log(np.abs(ratios) + 1e-12))
    far, worst = int(np.count_nonzero(off > 2.0 * _SPEED)), int(off.argmax())
    if not far:
        return ""
    return (
        f"the angle turns at another speed than stated in {far} of {ratios.size} recordings: at "
        f"{turned[worst]:.3g} instead of {stated[worst]:.3g} rad/s in the farthest"
    )


def speed_words(ratio: float, stated: float) -> str:
    """Return a finding on the ratio of the angle's speed to the stated one; empty if both agree.

    Parameters
    ----------
    ratio : float
        Speed of the angle divided by the stated speed [-].
    stated : float
        Stated speed [rad/s].

    Examples
    --------
    >>> speed_words(57.3, 2.0), speed_words(1.03, 2.0)
    ('channel angle looks like degrees, not rad (factor 57)', '')
    """
    if not ratio:
        return "channel angle does not turn"
    if abs(np.log(abs(ratio))) < _SPEED:
        turned = "channel angle turns against the stated speed: the sign of either is wrong"
        return turned if ratio < 0.0 else ""
    if unit := unit_of("angle", ratio):
        return f"channel angle looks like {unit}, not rad (factor {max(ratio, 1 / ratio):.2g})"
    if unit := unit_of("speed", 1.0 / ratio):
        return f"the stated speed looks like {unit}, not rad/s (factor {max(ratio, 1 / ratio):.2g})"
    turns = f"{ratio * stated:.2g} rad/s where {stated:.2g} rad/s is stated"
    if ratio < _STILL:
        return f"channel angle does not turn as stated: {turns}"
    return f"the stated speed is {factor_words(1.0 / ratio)}: the angle turns at {turns}"


_LEAST = 0.58
"""Least ratio of the largest mean torque of a case to the kinetic torque of the rig file [-]; an
effect that halves the torque does so only at some speeds; assumed."""

_FOLLOWS = 0.9
"""Least explained share and correlation of a path that determines the gain of the torque [-];
assumed."""

_ERRORS = np.array([0.04, 0.08, 0.08])
"""Standard errors of the logarithms of the torque's mean, swing and frequency, between repeats and
between rigs of one material [-]; assumed."""

_LIKE, _UNLIKE = 2.0, 3.0
"""Largest root mean square difference to the other material, and least difference to the rig file,
in standard errors and as a multiple of the former [-]; assumed."""

_CYCLES = (15.0, 1500.0)
"""Range of slip rates [Hz]; assumed."""


def another_level(levels: Sequence[Levels]) -> str:
    """Return a finding if friction is far below the rig file's at all conditions; else empty."""
    torques = [abs(one.torque) for one in levels if one.torque is not None]
    fits = [fit for one in levels for (kind, path), fit in one.paths.items() if kind == path]
    gains = [f.gain for f in fits if min(f.explained, abs(f.alike)) > _FOLLOWS]
    # Paths with a gain above 1 show that the torque sensor reads too low.
    read = max(float(np.median(gains)), 1.0) if gains else 1.0
    if not torques or max(torques) * read >= _LEAST:
        return ""
    return (
        f"the torque is {np.median(torques):.2g} of the rig file's kinetic torque, and at most "
        f"{max(torques):.2g} at any condition: another material, fit or rig"
    )


def another_material(
    case: Case, transfer_functions: TransferFunctionCache, library: Mapping[str, Effect] | None
) -> str:
    """Return a finding if a shipped material fits the torque and the rig file does not.

    Otherwise the text is empty.
    """
    if any(recording.first("torque") is None for recording in case.recordings):
        return ""
    courses = [_course(recording) for recording in case.recordings]

    def difference(rig: Rig, most: float) -> float:
        """Return the RMS difference to a rig [-], infinite above `most` [-]."""
        squares: list[Array] = []
        for course, recording in zip(courses, case.recordings, strict=True):
            at = _within(rig, recording)
            try:
                (made,) = nominal_repeats(at, rig, transfer_functions, [0], library=library)
            except BushingNoiseError:
                return np.inf
            squares.append(((course - _course(made)) / _ERRORS) ** 2)
            if sum(map(np.sum, squares)) > len(courses) * _ERRORS.size * most**2:
                return np.inf  # the other recordings cannot lower it
        return float(np.sqrt(np.concatenate(squares).mean()))

    own = difference(case.rig, np.inf)
    if own < _UNLIKE:
        return ""
    most = min(_LIKE, own / _UNLIKE)
    for name in material_names():
        other = load_material_rig(name)
        names = sorted((other.material, case.rig.material), key=len)
        if other.friction.name == case.rig.friction.name and names[1].startswith(names[0]):
            continue  # the same law with other parameters is not another material
        whole = replace(other, sensors=case.rig.sensors, measured=case.rig.measured)
        if difference(whole, most) < most:
            return f"the friction is that of {name}, not of the rig file: another material"
    return ""


def _course(recording: Recording) -> Array:
    """Return the logarithms of the torque's mean, standard deviation and frequency, shape (3,)."""
    row = recording.first("torque")
    x = np.asarray(recording.samples[row], dtype=np.float64)
    mean, swing = abs(float(x.mean())), float(x.std())
    if swing < SWINGING * mean:  # nothing slips; the spectrum is noise
        return np.log([max(mean, 1e-12), SWINGING * max(mean, 1e-12), _CYCLES[0]])
    power = np.abs(np.fft.rfft((x - x.mean()) * np.hanning(x.size), 4 * x.size)) ** 2
    frequency = np.fft.rfftfreq(4 * x.size, 1.0 / recording.rate)
    inside = (frequency > _CYCLES[0]) & (frequency < _CYCLES[1])
    middle = float(frequency[inside] @ power[inside]) / (float(power[inside].sum()) + 1e-300)
    return np.log(np.maximum([mean, swing, middle], 1e-12))


def _within(rig: Rig, recording: Recording) -> Recording:
    """Return a recording with its interference clipped to the range of a rig's fits."""
    condition = recording.condition
    assert condition.interference is not None  # ensured by `usable`
    nearest = float(np.clip(condition.interference, *rig.interference_range))
    return replace(recording, condition=replace(condition, interference=nearest))


_ANY_RIG = 3.0
"""Largest ratio of the torques of two rigs of one kind [-]; assumed."""


def bench_findings(case: Case, library: Mapping[str, Effect] | None = None) -> tuple[str, ...]:
    """Return findings on a case that contradict its rig.

    Parameters
    ----------
    case : Case
    library : mapping of str to Effect, optional
        Effects by name, which include those of the rig.

    Returns
    -------
    tuple of str
        One line per finding; empty if the case fits its rig.
    """
    if case.unusable:
        return case.unusable
    cache = TransferFunctionCache(case.rig, library)
    levels = [levels_of(recording, case.rig, cache) for recording in case.recordings]
    if swapped := swapped_outputs(levels):
        return (swapped,)
    each = (*turned_channels(levels), *wrong_units(levels), wrong_speed(levels))
    if findings := tuple(filter(None, each)):
        return findings
    other = another_level(levels) or another_material(case, cache, library)
    return (other,) if other else ()


def unit_findings(recordings: Sequence[Recording], rig: Rig) -> tuple[str, ...]:
    """Return findings on channels in a wrong unit, for a rig of which only the kind is known.

    Parameters
    ----------
    recordings : sequence of Recording
        Recordings with known conditions.
    rig : Rig
        Rig of the same kind, such as the initial rig of an identification.

    Returns
    -------
    tuple of str
        One line per channel; empty if all units are right or the rig does not cover the conditions.
    """
    cache = TransferFunctionCache(rig)
    try:
        levels = [levels_of(recording, rig, cache) for recording in recordings]
    except BushingNoiseError:  # the rig does not have this support
        return ()
    return tuple(text for text in wrong_units(levels, alike=_ANY_RIG) if " looks like " in text)
