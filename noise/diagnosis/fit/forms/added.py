"""Noise and hum added to channels, estimated: noise by its bands, hum by its lines."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft

from noise.diagnosis.fit.forms.form import Form, amount_form
from noise.diagnosis.gap.signature import KINDS, NAMES
from sim.effects.effect import Signals, Values

if TYPE_CHECKING:
    from noise.diagnosis.fit.forms.form import Compared


_SURE = 2.0
"""An excess counts from so many standard errors; the usual two of a normal distribution,
assumed."""

_UNSTEADY = 0.1
"""Relative standard error of a band's power; assumed."""

_HARMONICS = 80
_WANDER = 0.008
"""Of the mains' frequency; assumed."""

_BESIDE = (3, 8)
"""Lines beside one of the hum's that tell what it stands out of."""

_MOST_OF_LEAST = 4.0
"""Times the power that the recording with the least of it has in a line of the hum, which is in all
of them; assumed."""

_STANDS_OUT = 3.0
"""Times its neighbours' power; assumed."""


def _excess(compared: Sequence[Compared]) -> NDArray[np.float64]:
    """Power that bands surely have too much beside the nominal model, 0 elsewhere."""
    measured, nominal = (
        np.exp(2.0 * np.array([getattr(c, part) for c in compared]))
        for part in ("signature", "nominal")
    )
    scale = np.array([c.scale for c in compared])
    weight = 1.0 / ((2.0 * scale * nominal) ** 2 + (_UNSTEADY * measured) ** 2)
    excess = np.nansum(weight * (measured - nominal), axis=0) / np.nansum(weight, axis=0)
    return np.where(excess > _SURE / np.sqrt(np.nansum(weight, axis=0)), excess, 0.0)


def noise_forms(compared: Sequence[Compared]) -> list[Form]:
    """Estimate stationary noise: power that bands have too much, channel by channel."""
    excess = _excess(compared)
    bands: dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]] = {}
    for kind in KINDS:
        place, low = _bands(kind)
        power = np.nan_to_num(np.maximum(excess[place], 0.0))
        if power.any():
            edges = np.append(low, low[-1] * low[1] / low[0])
            bands[kind] = edges, power / np.diff(edges)
    if not bands:
        return []

    def sensors(
        signals: Signals, rate: float, _form: str, values: Values, rng: np.random.Generator
    ) -> Signals:
        noisy = dict(signals)
        for kind, (edges, density) in bands.items():
            noisy[kind] = noisy[kind] + values["amount"] * _noise(
                noisy[kind].size, rate, edges, density, rng
            )
        return noisy

    return [amount_form("background_noise", "estimated", sensors=sensors)]


def _bands(kind: str) -> tuple[list[int], NDArray[np.float64]]:
    """Places of a channel's bands in a signature, and where they begin [Hz]."""
    place = [i for i, name in enumerate(NAMES) if name.startswith(kind)]
    return place, np.array([float(NAMES[i].rpartition("_")[2]) for i in place])


def _noise(
    n: int,
    rate: float,
    edges: NDArray[np.float64],
    density: NDArray[np.float64],
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    length = next_fast_len(n, real=True)
    frequency = np.fft.rfftfreq(length, 1.0 / rate)
    place = np.clip(np.digitize(frequency, edges) - 1, 0, density.size - 1)
    inside = (frequency > 0.5 * edges[0]) & (frequency < edges[-1])
    size = np.sqrt(0.5 * rate * density[place] * inside)
    return np.asarray(irfft(size * rfft(rng.standard_normal(length)), length)[:n])


def hum_forms(compared: Sequence[Compared]) -> list[Form]:
    """Estimate the mains: their frequency, and the amplitude of each harmonic on each channel."""
    kinds = [kind for kind in KINDS if all(kind in c.measured for c in compared)]
    spectra = {k: [_spectrum(c.measured[k]) for c in compared] for k in kinds}
    rates = [c.rate / c.measured[k].size for k in kinds[:1] for c in compared]
    excess = _excess(compared)

    def found_at(frequency: float) -> tuple[float, dict[str, NDArray[np.float64]]]:
        score, lines = 0.0, {}
        for kind in kinds:
            parts = [_lines(p, d, frequency) for p, d in zip(spectra[kind], rates, strict=True)]
            line, usual = (np.array(x) for x in zip(*parts, strict=True))
            weight = 1.0 / usual**2
            mean = (weight * (line - usual)).sum(axis=0) / weight.sum(axis=0)
            mean = np.minimum(mean, _MOST_OF_LEAST * line.min(axis=0))
            sure = mean * np.sqrt(weight.sum(axis=0))
            # Slips have lines too, which other recordings and the nominal model tell from hum; and
            # chance in eighty lines that do not stand out would outweigh a plain tone.
            place, low = _bands(kind)
            band = np.searchsorted(low, frequency * np.arange(1, _HARMONICS + 1), "right") - 1
            clear = (sure > _STANDS_OUT) & (excess[place][np.maximum(band, 0)] > 0.0)
            lines[kind] = np.where(clear, mean, 0.0)
            score += float(np.log1p(sure[clear]).sum())
        return score, lines

    grid = [m * (1.0 + x) for m in (50.0, 60.0) for x in np.linspace(-_WANDER, _WANDER, 33)]
    frequency = max(grid, key=lambda f: found_at(f)[0])
    lines = found_at(frequency)[1]
    if not any(x.any() for x in lines.values()):
        return []

    def sensors(
        signals: Signals, rate: float, _form: str, values: Values, rng: np.random.Generator
    ) -> Signals:
        humming = dict(signals)
        for kind, power in lines.items():
            time, phases = np.arange(humming[kind].size) / rate, rng.random(_HARMONICS)
            added = np.zeros(time.size)
            for k in np.flatnonzero(power).tolist():
                turns = (k + 1) * frequency * time + phases[k]
                added += np.sqrt(2.0 * power[k]) * np.sin(2.0 * np.pi * turns)
            humming[kind] = humming[kind] + values["amount"] * added
        return humming

    return [amount_form("mains_hum", f"{frequency:.1f} Hz, estimated", sensors=sensors)]


def _spectrum(signal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean square a line."""
    window = np.hanning(signal.size)
    power = np.abs(rfft((signal - signal.mean()) * window)) ** 2
    return np.asarray(2.0 * power / (signal.size * float(window @ window)))


def _lines(
    power: NDArray[np.float64], spacing: float, frequency: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mean square about each harmonic, and what it would be of what lies beside."""
    near, far = _BESIDE
    line, usual = np.zeros(_HARMONICS), np.full(_HARMONICS, np.inf)
    for k in range(_HARMONICS):
        at = round((k + 1) * frequency / spacing)
        if at + far >= power.size or at <= far:
            continue
        beside = np.concatenate([power[at - far : at - near], power[at + near + 1 : at + far + 1]])
        line[k] = float(power[at - near + 1 : at + near].sum())
        usual[k] = (2 * near - 1) * float(beside.mean()) + 1e-30
    return line, usual
