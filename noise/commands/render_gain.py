"""Gain of the sounds of a set, as the options of ``render`` ask for it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from models.errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from noise.audio.rendering import FullScale, Survey

__all__ = ["faint_notes", "full_scales"]

_MOST_NAMED = 4


def full_scales(
    surveys: Mapping[str, Survey], *, pascal: float | None, matched: bool
) -> dict[str, FullScale]:
    """Choose the gain of the sounds of a set.

    Parameters
    ----------
    surveys : mapping of str to Survey
    pascal : float or None
        Sound pressure at full scale [Pa] for all of them.
    matched : bool
        Whether all get the same loudness. Without either they have one full scale in common.

    Raises
    ------
    ParameterError
        A sound would clip at `pascal` or is not calibrated, or a common gain would mean nothing.

    Examples
    --------
    >>> full_scales({}, pascal=None, matched=True)
    {}
    """
    if not surveys:
        return {}
    if matched:
        return _matched(surveys)
    if pascal is not None:
        return _calibrated(surveys, pascal)
    return _common(surveys)


def _matched(surveys: Mapping[str, Survey]) -> dict[str, FullScale]:
    from noise.audio.gain import matched_loudness
    from noise.audio.rendering import FullScale

    loudest = {name: of.loudness for name, of in surveys.items() if of.loudness is not None}
    target = matched_loudness(list(loudest.values()))
    return {
        name: FullScale(
            surveys[name].true_peak * 10.0 ** ((value - target) / 20.0), "matched", target
        )
        for name, value in loudest.items()
    }


def _calibrated(surveys: Mapping[str, Survey], pascal: float) -> dict[str, FullScale]:
    from noise.audio.gain import CEILING, full_scale_without_clipping
    from noise.audio.rendering import FullScale

    for of in surveys.values():
        if not of.calibrated:
            raise ParameterError(
                f"--pascal-per-full-scale needs a calibrated input, and {of.name} is not; "
                "--full-scale or --calibrator gives its calibration"
            )
    loudest = max(surveys.values(), key=lambda of: of.true_peak)
    if loudest.true_peak > CEILING * pascal:
        raise ParameterError(
            f"--pascal-per-full-scale {pascal:g} would clip {loudest.name}; the smallest that "
            f"does not is {full_scale_without_clipping(loudest.true_peak):g}"
        )
    return dict.fromkeys(surveys, FullScale(pascal, "calibrated"))


def _common(surveys: Mapping[str, Survey]) -> dict[str, FullScale]:
    import numpy as np

    from noise.audio.gain import QUIETEST_FULL_SCALE, common_full_scale
    from noise.audio.rendering import FullScale

    known = {of.calibrated: of.name for of in surveys.values()}
    if len(known) > 1:
        raise ParameterError(
            f"{known[True]} is calibrated and {known[False]} is not, so one gain cannot keep how "
            "loud they are to each other; --full-scale gives a calibration, --match-loudness "
            "needs none"
        )
    value = common_full_scale([np.array([of.true_peak]) for of in surveys.values()])
    if True in known:  # so that silence is not made loud
        value = max(value, QUIETEST_FULL_SCALE)
    return dict.fromkeys(surveys, FullScale(value, "common"))


def faint_notes(
    surveys: Mapping[str, Survey], scales: Mapping[str, FullScale], *, back_to_back: bool = False
) -> tuple[str, dict[str, str]]:
    """Say which sounds are nearly inaudible in their files, and what makes them audible.

    Parameters
    ----------
    surveys : mapping of str to Survey
    scales : mapping of str to FullScale
    back_to_back : bool
        Whether sounds are played behind one another, at one gain.

    Returns
    -------
    of_all : str
        In one line, empty where every sound can be heard.
    of_each : dict of str to str
        The same of each that can hardly be heard.

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel, Recording
    >>> from noise.audio.rendering import FullScale, survey
    >>> tone = 0.02 * np.sin(2 * np.pi * 1000 * np.arange(48000) / 48e3)[np.newaxis]
    >>> surveys = {"tone": survey([Recording(tone, 48e3, (Channel("pressure", "Pa"),))])}
    >>> print(faint_notes(surveys, full_scales(surveys, pascal=20.0, matched=False))[0])
    nearly inaudible (below -48 dBFS(A)) where the volume suits speech, unless playback is ...
    """
    from noise.audio.audibility import LEAST_AUDIBLE, nearly_inaudible

    faint = {n: of for n, of in surveys.items() if nearly_inaudible(of, scales[n].value)}
    if not faint:
        return "", {}
    scale = scales[next(iter(faint))]
    calibrated = scale.gain == "calibrated"
    lead = f"nearly inaudible (below {LEAST_AUDIBLE:g} dBFS(A)) where the volume suits speech"
    lead += f", unless playback is calibrated to {scale.value:g} Pa: " if calibrated else ": "
    remedy = ""
    if calibrated:
        louder = 20.0 * math.log10(scale.value / next(iter(_common(surveys).values())).value)
        remedy = f"; without --pascal-per-full-scale {louder:.0f} dB louder"
    if len(surveys) > 1 and not back_to_back and scale.gain != "matched":
        remedy += "; with --match-loudness as loud as the others"
    told = {name: _levels(name, of, scales[name].value) for name, of in faint.items()}
    named = ", ".join(list(told.values())[:_MOST_NAMED])
    more = f" and {len(told) - _MOST_NAMED} more" if len(told) > _MOST_NAMED else ""
    return lead + named + more + remedy, {name: lead + of + remedy for name, of in told.items()}


def _levels(name: str, of: Survey, full_scale: float) -> str:
    from noise.audio.audibility import loudest_in_file

    in_file = f"{loudest_in_file(of, full_scale):.1f} dBFS(A) in the file"
    if not of.calibrated:
        return f"{name} ({in_file})"
    level = max(one.levels.level_af_max for one in of.assessments)
    return f"{name} ({level:.1f} dB(A) at the microphone, {in_file})"
