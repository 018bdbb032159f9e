"""Further forms of what channels add and change: noise, hum, gain, delay, mount, overload."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from scipy.ndimage import map_coordinates
from scipy.signal import bilinear, butter, lfilter, lfilter_zi

from noise.diagnosis.cases.draws import SENSED, Array, Rng, slowly, telegraph, wander
from noise.training.causes.cases.variants.hooks import droop
from sim.effects.effect import Signals

Shares = Mapping[str, float]
Partials = tuple[Array, Array, Array]

_DECIBELS = 20.0
"""Of a gain's error at strength 1."""

_LEAST = 0.02
"""Of the gain that is left."""

_DEEPEST = 0.9
"""Share of the peak that is cut off at strength 1."""


def on_signals(a: float, change: Callable[[Signals, float, Rng], Signals]) -> dict[str, Any]:
    """Change all signals at once."""

    def sensors(signals: Signals, rate: float, _form: str, _values: Any, rng: Rng) -> Signals:
        return change(signals, rate, rng) if a > 0.0 else signals

    return {"sensors": sensors}


def _on_channels(
    a: float, shares: Shares, change: Callable[[Array, float, float, Rng], Array]
) -> dict[str, Any]:
    """Change channels; ``change(x, share, rate, rng)`` where the share is not 0."""

    def changed(signals: Signals, rate: float, rng: Rng) -> Signals:
        return {
            channel: change(x, shares[channel], rate, rng) if shares.get(channel, 0.0) else x
            for channel, x in signals.items()
        }

    return on_signals(a, changed)


def _added(
    a: float, levels: Array, series: Callable[[int, float, Rng], Array], *,
    together: bool = False, uneven: float = 0.0,
) -> dict[str, Any]:  # fmt: skip
    """Add a time series of rms 1 times a level to all channels, or to one or two of them.

    The same to all of them where they are disturbed together; louder in some runs than in others by
    so much (logarithmic).
    """
    shares = {k: s for k, s in zip(SENSED, (a * levels).tolist(), strict=True) if s > 0.0}

    def change(signals: Signals, rate: float, rng: Rng) -> Signals:
        louder = float(np.exp(uneven * np.clip(rng.standard_normal(), -2.0, 2.0)))
        added: Array | None = None
        changed = dict(signals)
        for channel in (c for c in SENSED if c in shares and c in signals):
            if added is None or not together:
                added = series(signals[channel].size, rate, rng)
                added = added / (float(np.sqrt(np.mean(added**2))) + 1e-30)
            changed[channel] = signals[channel] + louder * shares[channel] * added
        return changed

    return on_signals(a, change)


def noisy(
    a: float, form: str, levels: Array, *, together: bool = False, uneven: float = 0.0,
    series: str = "", **numbers: Any,
) -> dict[str, Any]:  # fmt: skip
    """Add random noise."""
    made = _NOISES[series or form]
    return _added(a, levels, lambda n, rate, rng: made(n, rate, rng, **numbers),
                  together=together, uneven=uneven)  # fmt: skip


def _coloured(n: int, rate: float, rng: Rng, exponent: float) -> Array:
    gain = np.maximum(np.fft.rfftfreq(n, 1.0 / rate), 20.0) ** (-0.5 * exponent)
    return np.asarray(np.fft.irfft(gain * np.fft.rfft(rng.standard_normal(n)), n))


def _bursts(n: int, rate: float, rng: Rng, often: float, quiet: float, exponent: float) -> Array:
    b, c = butter(1, 2.0 * 300.0 / rate)
    gate = lfilter(b, c, telegraph(rng, n, rate, often) > 0.0)
    return np.asarray((quiet + gate) * _coloured(n, rate, rng, exponent))


def _clicks(
    n: int, rate: float, rng: Rng, often: float, frequency: float, cycles: float, tails: float
) -> Array:
    heights = rng.standard_normal(n) * np.exp(tails * rng.standard_normal(n))
    impacts = heights * (rng.random(n) < often / rate)
    impacts[int(rng.integers(n))] += 1.0
    turn = frequency * np.arange(round(6.0 * cycles / frequency * rate) + 2) / rate
    ring = np.cos(2.0 * np.pi * turn) * np.exp(-turn / cycles)
    if ring.size < 64:
        return np.asarray(lfilter(ring, [1.0], impacts))
    m = n + ring.size
    return np.asarray(np.fft.irfft(np.fft.rfft(impacts, m) * np.fft.rfft(ring, m), m)[:n])


def _in_bands(n: int, rate: float, rng: Rng, middle: Any, octaves: float) -> Array:
    """Noise about one frequency, or about several [Hz]."""
    frequency = np.maximum(np.fft.rfftfreq(n, 1.0 / rate), 1.0)[:, None]
    gain = np.exp(-0.5 * (np.log2(frequency / np.atleast_1d(middle)) / octaves) ** 2).sum(axis=1)
    return np.asarray(np.fft.irfft(gain * np.fft.rfft(rng.standard_normal(n)), n))


def _swelling(n: int, rate: float, rng: Rng, corner: float, exponent: float, depth: float) -> Array:
    slow = wander(rng, n // 64 + 2, rate / 64.0, corner)
    swell = np.interp(np.arange(n), 64.0 * np.arange(slow.size), np.exp(depth * slow))
    return np.asarray(swell * _coloured(n, rate, rng, exponent))


def _machine(
    n: int, rate: float, rng: Rng, turning: float, blades: int, exponent: float, tonal: float,
    sizes: Array,
) -> Array:  # fmt: skip
    """Hum, whine and rush as a fan or a pump does: orders of a speed over coloured noise."""
    orders = np.array([1, 2, blades, 2 * blades, 3 * blades])
    turn = turning * (1.0 + 0.01 * rng.standard_normal()) * np.arange(n) / rate
    rush = _coloured(n, rate, rng, exponent)
    tones = sum(
        s * np.sin(2.0 * np.pi * (k * turn + rng.random()))
        for k, s in zip(orders.tolist(), sizes.tolist(), strict=True)
    )
    return np.asarray(rush / rush.std() + tonal / np.sqrt(orders.size) * tones)


def _speech(n: int, rate: float, rng: Rng, bands: Array, pace: float) -> Array:
    """Swell in syllables and sound in a few bands."""
    voice = _in_bands(n, rate, rng, bands, 0.25)
    syllables = np.sin(np.pi * (pace * np.arange(n) / rate + rng.random())) ** 2
    return np.asarray((0.05 + syllables) * voice)


_NOISES: dict[str, Callable[..., Array]] = {
    "colour": _coloured, "bursts": _bursts, "clicks": _clicks, "band": _in_bands,
    "swelling": _swelling, "machine": _machine, "speech": _speech,
    "popcorn": lambda n, rate, rng, often: telegraph(rng, n, rate, often),
}  # fmt: skip
"""Noise over time; popcorn jumps between two levels by chance, as poor contacts do."""


def following(a: float, levels: Array, exponent: float) -> dict[str, Any]:
    """Let noise rise with the signal itself: rough contact of a slip ring."""
    shares = dict(zip(SENSED, (0.7 * a * levels).tolist(), strict=True))

    def change(signals: Signals, rate: float, rng: Rng) -> Signals:
        changed = dict(signals)
        for channel in (c for c in signals if c in shares):
            x = signals[channel]
            z = _coloured(x.size, rate, rng, exponent)
            changed[channel] = x + shares[channel] * np.abs(x - x.mean()) * (z / z.std())
        return changed

    return on_signals(a, change)


def hums(
    a: float, form: str, frequency: float, corner: float, levels: Array, *, wobble: float = 0.0,
    depth: float = 0.0, uneven: float = 0.0, together: bool = False, **numbers: Any,
) -> dict[str, Any]:  # fmt: skip
    """Add a wave over the periods passed; frequency and level may wander."""
    wave = _WAVES.get(form, _harmonic)

    def series(n: int, rate: float, rng: Rng) -> Array:
        time = np.arange(n) / rate
        phases = rng.random(3)
        turns = (
            frequency * time + phases[0] + wobble * np.sin(2 * np.pi * (corner * time + phases[1]))
        )
        level = 1.0 + depth * np.sin(2 * np.pi * (0.7 * corner * time + phases[2]))
        return np.asarray(level * wave(turns, rate, rng, **numbers))

    return _added(a, levels, series, together=together, uneven=uneven)


def _harmonic(turns: Array, _rate: float, _rng: Rng, wave: Partials) -> Array:
    parts = zip(*(part.tolist() for part in wave), strict=True)
    return np.asarray(sum(c * np.sin(2 * np.pi * (k * turns + p)) for k, c, p in parts))


def _phase_cut(turns: Array, _rate: float, _rng: Rng, late: float) -> Array:
    """Let the sine begin late in each half-wave."""
    return np.where((2 * turns) % 1.0 > late, np.sin(2 * np.pi * turns), 0)


def _broken(turns: Array, rate: float, rng: Rng, often: float, wave: Partials) -> Array:
    whole = _harmonic(turns, rate, rng, wave)
    return np.asarray(whole * (0.05 + (telegraph(rng, turns.size, rate, often) > 0.0)))


def _spikes(
    turns: Array, _rate: float, _rng: Rng, wide: float, each: float, alternating: int
) -> Array:
    """Click with each half-wave."""
    place = (each * turns) % 1.0
    sign = np.where((each * turns) % 2.0 < 1.0, 1.0, -1.0) if alternating else 1.0
    return np.asarray(sign * np.exp(-place / wide) - (0.0 if alternating else wide))


_WAVES: dict[str, Callable[..., Array]] = {
    "phase_cut": _phase_cut, "intermittent": _broken, "spikes": _spikes,
}  # fmt: skip


def multiplying_hum(a: float, once: float, frequency: float, levels: Array) -> dict[str, Any]:
    """Modulate the gain of a channel rather than add to it: the ripple of a supply."""
    shares = dict(zip(SENSED, (0.8 * a * levels).tolist(), strict=True))

    def change(signals: Signals, rate: float, rng: Rng) -> Signals:
        turns = once * frequency / rate * np.arange(signals["torque"].size) + rng.random()
        hum = np.sin(2.0 * np.pi * turns)
        return {name: x * (1.0 + shares.get(name, 0.0) * hum) for name, x in signals.items()}

    return on_signals(a, change)


def _factor(sense: float, a: float) -> float:
    """Return a factor of the gain at a strength, up or down by as many decibels."""
    return float(10.0 ** (sense * _DECIBELS * a / 20.0))


def gains(
    a: float, form: str, sense: float, shares: Shares, way: Any = "", **numbers: Any
) -> dict[str, Any]:
    """Read channels with a wrong gain, the same all the time."""
    if not isinstance(way, str):  # a number of the form's own
        numbers["way"], way = way, ""
    change = _GAINS[way or form]
    return _on_channels(
        a, shares, lambda x, share, rate, rng: np.asarray(
            change(x, share, rate, rng, a=a, sense=sense, **numbers))
    )  # fmt: skip


def _each_run(x: Array, share: float, _rate: float, rng: Rng, *, a: float, sense: float) -> Array:
    """Read with another factor in each recording: a switch of ranges, a microphone moved."""
    spread = sense * 0.6 * _DECIBELS / 20.0 * np.log(10.0) * a
    return np.asarray(x * np.exp(spread * share * np.clip(rng.standard_normal(), -2.0, 2.0)))


def _tilted(
    x: Array, share: float, rate: float, _rng: Rng, *, a: float, sense: float, corner: float,
    steep: float, way: float,
) -> Array:  # fmt: skip
    """Let the error grow or fall with frequency, by no simple filter."""
    error = _factor(sense, 0.8 * a) - 1.0
    ratio = np.maximum(np.fft.rfftfreq(x.size, 1.0 / rate), 1.0) / corner
    wrong = 1.0 / (1.0 + ratio ** (way * steep))
    mirrored = np.fft.rfft(x - x.mean()) * wrong
    return np.asarray(x + share * error * np.fft.irfft(mirrored, x.size))


def _equalised(
    x: Array, share: float, rate: float, _rng: Rng, *, a: float, places: Array, wide: Array,
    levels: Array, **_drawn: float,
) -> Array:  # fmt: skip
    """Let the gain go up and down over frequency, as a poor response correction does."""
    levels = 0.8 * _DECIBELS / 20.0 * np.log(10.0) * a * levels
    levels[0] = abs(levels).max()
    frequency = np.maximum(np.fft.rfftfreq(x.size, 1.0 / rate), 1.0)
    octaves = np.log2(frequency[:, None] / places) / wide
    gain = np.exp(share * (levels * np.exp(-0.5 * octaves**2)).sum(axis=1))
    mean = x.mean()
    return np.asarray(mean + np.fft.irfft(gain * np.fft.rfft(x - mean), x.size))


def _blended(
    x: Array, share: float, rate: float, _rng: Rng, *, a: float, corner: float, order: int,
    kind: str, **_drawn: float,
) -> Array:  # fmt: skip
    """Blend in what a filter of first or second order leaves."""
    passed = _filtered(x, *butter(order, min(2.0 * corner / rate, 0.9), kind))
    return np.asarray(x + a * share * (passed - x))


def _bent(
    x: Array, share: float, _rate: float, _rng: Rng, *, a: float, error: float, power: float,
    swings: bool, **_drawn: float,
) -> Array:  # fmt: skip
    """Let the gain depend on the reading, or on its swing about the mean."""
    centre = float(x.mean()) if swings else 0.0
    y = x - centre
    peak = float(np.abs(y).max()) or 1.0
    return np.asarray(centre + y * (1.0 + error * a * share * (np.abs(y) / peak) ** power))


def _one_sided(
    x: Array, share: float, _rate: float, _rng: Rng, *, a: float, sense: float, above: int
) -> Array:
    """Read what is above the mean with another gain than what is below."""
    y = x - x.mean()
    return np.asarray(x + (_factor(sense, 0.7 * a) ** share - 1.0) * y * ((y > 0.0) == above))


_GAINS: dict[str, Callable[..., Array]] = {
    "decibels": lambda x, share, _rate, _rng, a, sense: _factor(sense, a) ** share * x,
    "mixed": lambda x, share, _rate, _rng, a, sense: np.exp(np.log(_factor(sense, a)) * share) * x,
    "each_run": _each_run, "tilted": _tilted, "equalised": _equalised, "filtered": _blended,
    "bent": _bent, "one_sided": _one_sided,
}  # fmt: skip


def varying_gains(
    a: float, form: str, sense: float, shares: Shares, **numbers: Any
) -> dict[str, Any]:
    """Let a gain be wrong by more or less over time."""
    error = _factor(sense, 0.7 * a) - 1.0

    def change(x: Array, share: float, rate: float, rng: Rng) -> Array:
        course = _COURSES[form](x.size, rate, rng, **numbers)
        return np.asarray(x * np.maximum(1.0 + error * share * course, _LEAST))

    return _on_channels(a, shares, change)


def delays(a: float, form: str, latest: float, shares: Shares, **numbers: Any) -> dict[str, Any]:
    """Let channels come late by more or less over time."""
    delay = a * latest

    def change(x: Array, share: float, rate: float, rng: Rng) -> Array:
        late = _LATE.get(form, _COURSES.get(form, _swinging))(x.size, rate, rng, **numbers)
        when = np.arange(x.size) - share * delay * rate * late
        return np.interp(when, np.arange(x.size), x)

    return _on_channels(a, shares, change)


def _settling(n: int, rate: float, _rng: Rng, time: float, sign: int) -> Array:
    gone = np.exp(-np.arange(n) / (time * rate))
    return np.asarray(gone if sign else 1.0 - gone)


def _stepping(n: int, _rate: float, rng: Rng, later: int) -> Array:
    """Change once, somewhere in the recording."""
    return np.where((np.arange(n) >= int(n * rng.uniform(0.1, 0.9))) == later, 1.0, 0.0)


_COURSES: dict[str, Callable[..., Array]] = {
    "wandering": lambda n, rate, rng, corner, mean: mean + 0.7 * slowly(rng, n, rate, corner),
    "switching": lambda n, rate, rng, often: 0.5 + 0.5 * telegraph(rng, n, rate, often),
    "stepping": _stepping,
    "settling": _settling,
}


def _packets(n: int, rate: float, rng: Rng, length: float) -> Array:
    late = rng.exponential(0.7, math.ceil(n / (length * rate)) + 1)
    return np.asarray(late[(np.arange(n) / (length * rate)).astype(np.int64)])


def _late_start(n: int, _rate: float, rng: Rng, sides: int) -> Array:
    """Start each recording by another delay: a trigger that is late by chance."""
    late = rng.normal() if sides else rng.exponential()
    return np.full(n, float(np.sign(late) * max(abs(late), 0.2)))


def _swinging(n: int, rate: float, rng: Rng, frequency: float, mean: float) -> Array:
    """Swing about a delay: a tape, a phase-locked loop."""
    turn = frequency * np.arange(n) / rate + rng.random()
    return np.asarray(mean + 0.7 * np.sin(2.0 * np.pi * turn))


_LATE: dict[str, Callable[..., Array]] = {
    "packets": _packets,
    "each_run": _late_start,
    "step": lambda n, _rate, rng: _stepping(n, _rate, rng, 1),
    "corrected": lambda n, rate, rng, length: (
        np.arange(n) / (length * rate) + rng.random()) % 1.0,
}  # fmt: skip
"""A buffer lost once (step), two clocks that are made to agree again and again (corrected)."""


def lost_packets(a: float, size: float, kept: float, mean: float, shares: Shares) -> dict[str, Any]:
    """Lose packets: the one before is read again, or silence."""
    chance = 0.5 * a

    def change(x: Array, share: float, rate: float, rng: Rng) -> Array:
        length = max(2, round(size * rate))
        at = np.arange(x.size)
        lost = (rng.random(x.size // length + 1) < chance * abs(share))[at // length]
        late = np.interp(at - share * (a * mean) * rate, at, x)
        again = late[np.maximum(at - length, 0)]
        return np.asarray(np.where(lost, kept * again + (1.0 - kept) * x.mean(), late))

    return _on_channels(a, shares, change)


def dispersive(
    a: float, latest: float, corner: float, steep: float, way: float, shares: Shares
) -> dict[str, Any]:
    """Delay by an amount that depends on frequency, all levels being kept."""

    def change(x: Array, share: float, rate: float, _rng: Rng) -> Array:
        n = 2 * x.size
        frequency = np.fft.rfftfreq(n, 1.0 / rate)
        group = a * latest / (1.0 + (np.maximum(frequency, 1.0) / corner) ** (way * steep))
        phase = 2.0 * np.pi * np.cumsum(group) * frequency[1]
        mirrored = np.concatenate([x, x[::-1]])
        return np.asarray(
            np.fft.irfft(np.fft.rfft(mirrored) * np.exp(-1j * share * phase), n)[: x.size]
        )

    return _on_channels(a, shares, change)


def whole_delay(a: float, latest: float, shares: Shares) -> dict[str, Any]:
    """Come late by a constant, read exactly: two front-ends, a wireless link."""

    def change(x: Array, share: float, rate: float, _rng: Rng) -> Array:
        when = np.clip(np.arange(x.size) - share * (a * latest) * rate, 0.0, x.size - 1.0)
        return np.asarray(map_coordinates(x, [when], order=3, mode="mirror"))

    return _on_channels(a, shares, change)


def mounts(a: float, form: str, shares: Shares, way: str = "", **numbers: Any) -> dict[str, Any]:
    """Take away what the mount does not pass."""
    lost = _MOUNTS[way or form]
    return _on_channels(a, shares, lambda x, share, rate, _rng: np.asarray(
        x - a * share * lost(x, rate, **numbers)))  # fmt: skip


def _filtered(x: Array, b: Array, c: Array) -> Array:
    return np.asarray(lfilter(b, c, x, zi=lfilter_zi(b, c) * x[0])[0])


def _mode(x: Array, rate: float, frequency: float, damping: float, numerator: list[float]) -> Array:
    """Filter by a mode, with a numerator in falling powers of s / omega."""
    share = min(frequency / rate, 0.45)
    tuned = 0.5 / math.tan(math.pi * share)
    return _filtered(x, *bilinear(numerator, [1.0, 2.0 * damping, 1.0], fs=tuned))


def _moving(x: Array, rate: float, frequency: float, damping: float) -> Array:
    """Relative motion of a mode below its base, of gain 1 far above: a stud's, a magnet's."""
    return _mode(x, rate, frequency, damping, [1.0, 0.0, 0.0])


def _several(
    x: Array, rate: float, n: int, frequency: Array, damping: Array, parts: Array
) -> Array:
    modes = zip(frequency.tolist(), damping.tolist(), parts.tolist(), strict=True)
    return np.asarray(sum(part * _moving(x, rate, f, d) for f, d, part in list(modes)[:n]))


def _cascade(
    x: Array, rate: float, frequency: float, second: float, damping: float, second_damping: float
) -> Array:
    base = x - _moving(x, rate, frequency, damping)
    return np.asarray(x - (base - _moving(base, rate, second, second_damping)))


def _absorbing(x: Array, rate: float, frequency: float, damping: float) -> Array:
    """Swallow a band rather than ring in it, as a cable or a putty does."""
    return _mode(x, rate, frequency, damping, [0.0, 2.0 * damping, 0.0])


def _soft(x: Array, rate: float, corner: float, order: int) -> Array:
    return np.asarray(x - _filtered(x, *butter(order, 2.0 * min(corner, 0.45 * rate) / rate)))


def _lifting(x: Array, rate: float, frequency: float, damping: float, level: float) -> Array:
    """Lift off where the motion pulls: what is beyond a level is read as a ringing less."""
    over = np.maximum(x - level * x.std() - x.mean(), 0.0)
    return np.asarray(over + _moving(over, rate, frequency, damping))


_MOUNTS: dict[str, Callable[..., Array]] = {
    "moving": _moving, "several": _several, "cascade": _cascade, "absorbing": _absorbing,
    "soft": _soft, "lifting": _lifting,
    "peak": lambda x, rate, frequency, damping, peak: -peak * _absorbing(
        x, rate, frequency, damping),
}  # fmt: skip
"""A peak does not lose what lies above: a bracket beside the sensor."""


def clips(a: float, form: str, shares: Shares, **numbers: Any) -> dict[str, Any]:
    """Limit a channel over its peak: ``limited(x / peak, cut, rate)``."""

    def change(x: Array, share: float, rate: float, _rng: Rng) -> Array:
        peak = float(np.abs(x).max())
        if peak == 0.0:
            return x
        cut = _DEEPEST * a * share * (1.0 - abs(float(x.mean())) / peak)
        return np.asarray(peak * _CLIPS[form](x / peak, cut, rate, **numbers))

    return _on_channels(a, shares, change)


def _polynomial(x: Array, cut: float, _rate: float, power: float) -> Array:
    # Rising as far as 1: of what a higher cut asks beyond, the rest is cut hard.
    bent = min(cut, 1.0 / (power + 1.0))
    y = x * (1.0 - bent * np.abs(x) ** power)
    return np.asarray(np.clip(y, cut - 1.0, 1.0 - cut))


def _wrapped(x: Array, cut: float, _rate: float) -> Array:
    limit = 1.0 - cut
    return np.where(np.abs(x) > limit, (x + limit) % (2.0 * limit) - limit, x)


def _folded(x: Array, cut: float, _rate: float, back: float) -> Array:
    over = np.maximum(np.abs(x) - (1.0 - cut), 0.0)
    return np.asarray(np.sign(x) * (np.minimum(np.abs(x), 1.0 - cut) - back * over))


def _recovering(x: Array, cut: float, rate: float, time: float, deep: float) -> Array:
    return np.asarray(droop(np.ascontiguousarray(x), 1.0 - cut, deep, 1.0 / (time * rate)))


def _bent_table(x: Array, cut: float, _rate: float, shape: Array) -> Array:
    # True up to a knee, from there by a random curve to the peak's reading.
    size, knee = np.abs(x), max(1.0 - 2.0 * cut, 0.2)
    knots = np.linspace(0.0, 1.0, shape.size - 1)
    above = np.interp((size - knee) / (1.0 - knee), knots, shape[1:])
    top = max(1.0 - cut - knee, 0.0)
    bent = np.minimum(size, min(knee, 1.0 - cut)) + np.where(size > knee, top * above, 0.0)
    return np.asarray(np.sign(x) * (bent if cut > 0.0 else size))


_CLIPS: dict[str, Callable[..., Array]] = {
    "polynomial": _polynomial, "wrapped": _wrapped, "folded": _folded, "recovering": _recovering,
    "table": _bent_table,
}  # fmt: skip


def limits(a: float, form: str, shares: Shares, **numbers: Any) -> dict[str, Any]:
    """Limit the swing about the mean, over its peak: ``limited(y, limit, rate, rng)``."""

    def change(x: Array, share: float, rate: float, rng: Rng) -> Array:
        mean = float(x.mean())
        peak = float(np.abs(x - mean).max()) or 1.0
        limit = 1.0 - _DEEPEST * a * share
        return np.asarray(
            mean + peak * _LIMITS[form]((x - mean) / peak, limit, rate, rng, **numbers)
        )

    return _on_channels(a, shares, change)


def _one_side(y: Array, limit: float, _rate: float, _rng: Rng, above: int) -> Array:
    side = limit * float(y.max() if above else -y.min())
    return np.minimum(y, side) if above else np.maximum(y, -side)


def _saturating(y: Array, limit: float, _rate: float, _rng: Rng, p: float) -> Array:
    """Saturate by any sharpness from a valve's to a rail's: y / (1 + |y / L|^p)^(1/p)."""
    if limit >= 1.0:
        return y
    rail = limit / (1.0 - limit**p) ** (1.0 / p)  # so that the peak reads the limit
    return np.asarray(y / (1.0 + np.abs(y / rail) ** p) ** (1.0 / p))


def _limit_filtered(
    y: Array, limit: float, rate: float, _rng: Rng, order: int, corner: float
) -> Array:
    """Clip before a filter, which rounds the corners and lets them ring."""
    b, c = butter(order, min(2.0 * corner / rate, 0.9))
    return np.asarray(y - lfilter(b, c, y - np.clip(y, -limit, limit)))


def _some_runs(y: Array, limit: float, _rate: float, rng: Rng) -> Array:
    """Clip some recordings more than others, as one range does for all."""
    own = 1.0 - (1.0 - limit) * float(rng.uniform(0.0, 1.0)) ** 0.5
    return np.clip(y, -own, own)


def _compressed(y: Array, limit: float, _rate: float, _rng: Rng, slope: float) -> Array:
    """Go on above the limit with a smaller slope: a compressor, a sensor beyond its range."""
    over = np.maximum(np.abs(y) - limit, 0.0)
    return np.asarray(y - np.sign(y) * (1.0 - slope) * over)


_LIMITS: dict[str, Callable[..., Array]] = {
    "swings": lambda y, limit, _rate, _rng: np.clip(y, -limit, limit),
    "one_side": _one_side,
    "unequal": lambda y, limit, _rate, _rng, other: np.clip(
        y, -(1.0 - other * (1.0 - limit)), limit),
    "saturating": _saturating,
    "filtered": _limit_filtered,
    "some_runs": _some_runs,
    "crossover": lambda y, limit, _rate, _rng: (
        np.sign(y) * np.maximum(np.abs(y) - 0.3 * (1.0 - limit), 0.0)),
    "compressed": _compressed,
}  # fmt: skip
"""Both sides of a signal coupled for alternating current, a supply that is not symmetrical,
nothing near zero (a sticky pen, a noise gate)."""


def clipped_reading(a: float, shares: Shares) -> dict[str, Any]:
    """Clip the reading itself, mean and all: a torque beyond its range is a flat line."""

    def change(x: Array, share: float, _rate: float, _rng: Rng) -> Array:
        limit = (1.0 - 0.85 * a * share) * float(np.abs(x).max())
        return np.clip(x, -limit, limit)

    return _on_channels(a, shares, change)
