"""Levels of a sound in air and in the written file, and levels of sound power.

Levels in the air are those of the recording before it is faded and resampled, so that they are
the measurement's and a gain does not change them. Without a calibration there is no level in the
air, and all levels are told re full scale of the file that is written.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from features.kernels.levels import NOMINAL_THIRD_OCTAVES
from features.kernels.weighting import SoundLevels, a_weighting, sound_levels
from models.recording import REFERENCE_PRESSURE, Recording
from noise.audio.sound import pressure_channel

if TYPE_CHECKING:
    from sim.analysis.sound_power import BandPower

COLUMNS = (
    *("level_db", "level_dba", "l_afmax_dba", "level_dbfs"),
    *(f"third_octave_{band}_hz_db" for band in NOMINAL_THIRD_OCTAVES),
)
"""Of a table of levels, in the order of a sound level meter's."""

POWER_COLUMNS = ("band_hz", "power_level_db", "power_level_dba")
"""Nominal middle of the band, sound power levels [dB re 1 pW] of the plate in a rigid baffle."""

TOTAL = "total"
"""What stands for the band in the last row, the sum of all bands."""


@dataclass(frozen=True)
class Assessment:
    """Levels of a recording.

    Parameters
    ----------
    levels : SoundLevels
        Re 20 uPa where `calibrated`, otherwise re full scale of the recording.
    calibrated : bool
    """

    levels: SoundLevels
    calibrated: bool

    def in_file(self, full_scale: float) -> SoundLevels:
        """Return levels re full scale [unit of the recording] of the written file."""
        reference = REFERENCE_PRESSURE if self.calibrated else 1.0
        return self.levels.raised(20.0 * math.log10(reference / full_scale))

    def row(self, full_scale: float) -> dict[str, object]:
        """Return known cells by `COLUMNS` at a full scale [Pa]."""
        row: dict[str, object] = {"level_dbfs": _rounded(self.in_file(full_scale).level)}
        if self.calibrated:
            row |= {
                "level_db": _rounded(self.levels.level),
                "level_dba": _rounded(self.levels.level_a),
                "l_afmax_dba": _rounded(self.levels.level_af_max),
            }
            for band, level in self.levels.third_octaves.items():
                row[f"third_octave_{band}_hz_db"] = _rounded(level)
        return row

    def entry(self, full_scale: float) -> dict[str, object]:
        """Return the values of `row` for a sidecar, third octaves as an object."""
        row = self.row(full_scale)
        entry = {key: row[key] for key in COLUMNS if key in row and "third_octave" not in key}
        if self.calibrated:
            octaves = self.levels.third_octaves
            entry["third_octaves_db"] = {band: _rounded(octaves[band]) for band in octaves}
        return entry

    def words(self, full_scale: float) -> str:
        """Return the values of `row` as text, without third octaves."""
        levels = self.levels if self.calibrated else self.in_file(full_scale)
        unit, re = ("dB", " re 20 uPa") if self.calibrated else ("dBFS", "")
        return (
            f"{levels.level_a:.1f} {unit}(A), L_AFmax {levels.level_af_max:.1f} {unit}, "
            f"{levels.level:.1f} {unit} unweighted{re}"
        )


def assess(recording: Recording) -> Assessment:
    """Measure the sound of a recording's first pressure channel.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    Assessment

    Raises
    ------
    ParameterError
        There is no pressure channel, or it can't be analysed.

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel
    >>> tone = np.sqrt(2) * np.sin(2 * np.pi * 1000 * np.arange(48000) / 48e3)
    >>> of = assess(Recording(tone[np.newaxis], 48e3, (Channel("pressure"),)))
    >>> of.row(full_scale=2.0)["level_db"], of.row(full_scale=2.0)["level_dbfs"]
    (93.98, -6.02)
    """
    sound, rate = recording[pressure_channel(recording).name], recording.rate
    calibrated = recording.calibrated
    levels = sound_levels(sound, rate, reference=REFERENCE_PRESSURE if calibrated else 1.0)
    return Assessment(levels, calibrated)


def _rounded(value: float, digits: int = 2) -> float | None:
    return round(float(value), digits) if math.isfinite(value) else None


def sound_power_rows(power: "BandPower") -> list[dict[str, object]]:
    """Return rows by `POWER_COLUMNS`, one per band and one for the sum.

    Parameters
    ----------
    power : BandPower

    Returns
    -------
    list of dict
        Levels in dB re 1 pW to 0.01 dB; None for a band without power.
    """
    levels = [power.level, power.level + a_weighting(power.centre)]
    first = NOMINAL_THIRD_OCTAVES.index(f"{power.centre[0]:.0f}")
    bands = (*NOMINAL_THIRD_OCTAVES[first : first + power.level.size], TOTAL)
    columns = [[*map(_rounded, column), _rounded(_sum(column))] for column in levels]
    return [dict(zip(POWER_COLUMNS, row, strict=True)) for row in zip(bands, *columns, strict=True)]


def _sum(levels: NDArray[np.float64]) -> float:
    with np.errstate(divide="ignore"):
        return float(10.0 * np.log10(np.sum(10.0 ** (levels / 10.0))))
