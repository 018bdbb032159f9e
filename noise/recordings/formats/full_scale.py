"""What digital full scale is worth, where a file or its name says so in words.

A WAV file has no field for calibration, so meters put it into the name of the file
(``..._FS129.9dB(PK)_00.wav``) or its description (``0dBFS = 109.7 dBSPL``,
``0dBFS = 2.40 mps2``).

Convention: a stated level is that of the *peak* at full scale, so the sample 1.0 is worth
20 uPa * 10^(L/20). The names say ``PK``, and the maker of these meters scales samples by that same
formula with the level of the description (NTi Audio, XL2 manual on WAV recording and support note
on scaling WAV files). Reading it as the rms of a full-scale sine would be 3 dB higher.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from models.recording import REFERENCE_PRESSURE

__all__ = ["FullScale", "stated_full_scale"]

_NUMBER = r"(-?\d{1,3}(?:[.,]\d{1,6})?)"
_IN_NAME = re.compile(rf"(?<![a-z0-9])FS\s*{_NUMBER}\s*dB[\s_(-]*PK(?![a-z0-9])", re.I | re.A)
_PRESSURE = re.compile(rf"0\s*dB\s*FS\s*=\s*{_NUMBER}\s*dB\s*SPL(?![a-z0-9])", re.I | re.A)
_ACCELERATION = re.compile(
    rf"0\s*dB\s*FS\s*=\s*{_NUMBER}\s*(?:mps2|m/s(?:\^?2|²))(?![a-z0-9])", re.I | re.A
)


@dataclass(frozen=True)
class FullScale:
    """The value of a full-scale sample.

    Parameters
    ----------
    kind : str
        ``"pressure"`` or ``"acceleration"``, as in `models.recording.CHANNEL_UNITS`.
    value : float
        [Pa] or [m/s^2].
    """

    kind: str
    value: float


def stated_full_scale(text: str) -> FullScale | None:
    """Find the value of full scale in a description, a comment or the name of a file.

    Parameters
    ----------
    text : str
        Anything at all.

    Returns
    -------
    FullScale or None
        None where the text states nothing.

    Examples
    --------
    >>> stated_full_scale("2019-10-17_SLM_012_Audio_FS94.0dB(PK)_00.wav")
    FullScale(kind='pressure', value=1.002...)
    >>> stated_full_scale("Vibration: 0dBFS = 2.40 mps2 Time Zone: UTC-09:00 (DST)")
    FullScale(kind='acceleration', value=2.4)
    >>> stated_full_scale("rainy, some traffic") is None
    True
    """
    for pattern in (_IN_NAME, _PRESSURE):
        if level := pattern.search(text):
            return FullScale("pressure", REFERENCE_PRESSURE * 10 ** (_number(level) / 20))
    if (value := _ACCELERATION.search(text)) and _number(value) > 0:
        return FullScale("acceleration", _number(value))
    return None


def _number(match: re.Match[str]) -> float:
    return float(match[1].replace(",", "."))
