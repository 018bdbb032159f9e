"""Gain of the sounds of a set, as the options of ``render`` ask for it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from noise.audio.rendering import FullScale, Survey

__all__ = ["full_scales"]


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
