"""Further forms of what channels add and change: noise, hum, gain, delay, mount, overload."""

from __future__ import annotations

import math

import numpy as np
from scipy.ndimage import map_coordinates
from scipy.signal import bilinear, butter, lfilter, lfilter_zi

from noise.diagnosis.cases.draws import SENSED, slowly, telegraph, wander
from noise.training.causes.cases.variants.hooks import droop

_DECIBELS = 20.0
"""Of a gain's error at strength 1."""

_DEEPEST = 0.9
"""Share of the peak that is cut off at strength 1."""


def on_signals(a, change):
    """Change all signals at once, by ``change(signals, rate, rng)``."""

    def sensors(signals, rate, _form, _values, rng):
        return change(signals, rate, rng) if a > 0.0 else signals

    return {"sensors": sensors}


def _on_channels(a, shares, change):
    """Change channels by ``change(x, share, rate, rng)`` where the share is not 0."""
    return on_signals(a, lambda signals, rate, rng: {
        channel: change(x, shares[channel], rate, rng) if shares.get(channel, 0.0) else x
        for channel, x in signals.items()
    })  # fmt: skip


def _added(a, levels, series, *, together=False, uneven=0.0):
    """Add a time series of rms 1 times a level to all channels, or to one or two of them.

    The same to all of them where they are disturbed together; louder in some runs than in others by
    so much (logarithmic).
    """
    shares = {k: s for k, s in zip(SENSED, (a * levels).tolist(), strict=True) if s > 0.0}

    def change(signals, rate, rng):
        louder = float(np.exp(uneven * np.clip(rng.standard_normal(), -2.0, 2.0)))
        added, changed = None, dict(signals)
        for channel in (c for c in SENSED if c in shares and c in signals):
            if added is None or not together:
                added = series(signals[channel].size, rate, rng)
                added = added / (float(np.sqrt(np.mean(added**2))) + 1e-30)
            changed[channel] = signals[channel] + louder * shares[channel] * added
        return changed

    return on_signals(a, change)


def noisy(a, form, levels, *, together=False, uneven=0.0, series="", **numbers):
    """Add random noise."""
    made = _NOISES[series or form]
    return _added(a, levels, lambda *run: made(*run, **numbers), together=together, uneven=uneven)


def _coloured(n, rate, rng, exponent):
    gain = np.maximum(np.fft.rfftfreq(n, 1.0 / rate), 20.0) ** (-0.5 * exponent)
    return np.fft.irfft(gain * np.fft.rfft(rng.standard_normal(n)), n)


def _bursts(n, rate, rng, often, quiet, exponent):
    gate = lfilter(*butter(1, 2.0 * 300.0 / rate), telegraph(rng, n, rate, often) > 0.0)
    return (quiet + gate) * _coloured(n, rate, rng, exponent)


def _clicks(n, rate, rng, often, frequency, cycles, tails):
    heights = rng.standard_normal(n) * np.exp(tails * rng.standard_normal(n))
    impacts = heights * (rng.random(n) < often / rate)
    impacts[int(rng.integers(n))] += 1.0
    turn = frequency * np.arange(round(6.0 * cycles / frequency * rate) + 2) / rate
    ring = np.cos(2.0 * np.pi * turn) * np.exp(-turn / cycles)
    if ring.size < 64:
        return lfilter(ring, [1.0], impacts)
    m = n + ring.size
    return np.fft.irfft(np.fft.rfft(impacts, m) * np.fft.rfft(ring, m), m)[:n]


def _in_bands(n, rate, rng, middle, octaves):
    """Noise about one frequency, or about several [Hz]."""
    frequency = np.maximum(np.fft.rfftfreq(n, 1.0 / rate), 1.0)[:, None]
    gain = np.exp(-0.5 * (np.log2(frequency / np.atleast_1d(middle)) / octaves) ** 2).sum(axis=1)
    return np.fft.irfft(gain * np.fft.rfft(rng.standard_normal(n)), n)


def _swelling(n, rate, rng, corner, exponent, depth):
    slow = wander(rng, n // 64 + 2, rate / 64.0, corner)
    swell = np.interp(np.arange(n), 64.0 * np.arange(slow.size), np.exp(depth * slow))
    return swell * _coloured(n, rate, rng, exponent)


def _machine(n, rate, rng, turning, blades, exponent, tonal, sizes):
    """Hum, whine and rush as a fan or a pump does: orders of a speed over coloured noise."""
    orders = np.array([1, 2, blades, 2 * blades, 3 * blades])
    turn = turning * (1.0 + 0.01 * rng.standard_normal()) * np.arange(n) / rate
    rush = _coloured(n, rate, rng, exponent)
    pairs = zip(orders.tolist(), sizes.tolist(), strict=True)
    tones = sum(s * np.sin(2.0 * np.pi * (k * turn + rng.random())) for k, s in pairs)
    return rush / rush.std() + tonal / np.sqrt(orders.size) * tones


def _speech(n, rate, rng, bands, pace):
    """Swell in syllables and sound in a few bands."""
    voice = _in_bands(n, rate, rng, bands, 0.25)
    syllables = np.sin(np.pi * (pace * np.arange(n) / rate + rng.random())) ** 2
    return (0.05 + syllables) * voice


_NOISES = {
    "colour": _coloured, "bursts": _bursts, "clicks": _clicks, "band": _in_bands,
    "swelling": _swelling, "machine": _machine, "speech": _speech,
    "popcorn": lambda n, rate, rng, often: telegraph(rng, n, rate, often),
}  # fmt: skip
"""Noise over time; popcorn jumps between two levels by chance, as poor contacts do."""


def following(a, levels, exponent):
    """Let noise rise with the signal itself: rough contact of a slip ring."""

    def change(x, share, rate, rng):
        z = _coloured(x.size, rate, rng, exponent)
        return x + share * np.abs(x - x.mean()) * (z / z.std())

    shares = dict(zip(SENSED, (0.7 * a * levels).tolist(), strict=True))
    return _on_channels(a, shares, change)


def hums(
    a, form, frequency, corner, levels, *, wobble=0.0, depth=0.0, uneven=0.0, together=False,
    **numbers
):  # fmt: skip
    """Add a wave over the periods passed; frequency and level may wander."""
    wave = _WAVES.get(form, _harmonic)

    def series(n, rate, rng):
        time, phases = np.arange(n) / rate, rng.random(3)
        turns = (
            frequency * time + phases[0] + wobble * np.sin(2 * np.pi * (corner * time + phases[1]))
        )
        level = 1.0 + depth * np.sin(2 * np.pi * (0.7 * corner * time + phases[2]))
        return level * wave(turns, rate, rng, **numbers)

    return _added(a, levels, series, together=together, uneven=uneven)


def _harmonic(turns, _rate, _rng, wave):
    parts = zip(*(part.tolist() for part in wave), strict=True)
    return sum(c * np.sin(2 * np.pi * (k * turns + p)) for k, c, p in parts)


def _broken(turns, rate, rng, often, wave):
    whole = _harmonic(turns, rate, rng, wave)
    return whole * (0.05 + (telegraph(rng, turns.size, rate, often) > 0.0))


def _spikes(turns, _rate, _rng, wide, each, alternating):
    """Click with each half-wave."""
    place = (each * turns) % 1.0
    sign = np.where((each * turns) % 2.0 < 1.0, 1.0, -1.0) if alternating else 1.0
    return sign * np.exp(-place / wide) - (0.0 if alternating else wide)


_WAVES = {
    "phase_cut": lambda turns, _rate, _rng, late: (
        np.where((2 * turns) % 1.0 > late, np.sin(2 * np.pi * turns), 0)),
    "intermittent": _broken, "spikes": _spikes,
}  # fmt: skip
"""A phase that is cut has the sine begin late in each half-wave."""


def multiplying_hum(a, once, frequency, levels):
    """Modulate the gain of a channel rather than add to it: the ripple of a supply."""
    shares = dict(zip(SENSED, (0.8 * a * levels).tolist(), strict=True))

    def change(signals, rate, rng):
        turns = once * frequency / rate * np.arange(signals["torque"].size) + rng.random()
        hum = np.sin(2.0 * np.pi * turns)
        return {name: x * (1.0 + shares.get(name, 0.0) * hum) for name, x in signals.items()}

    return on_signals(a, change)


def _factor(sense, a):
    """Return a factor of the gain at a strength, up or down by as many decibels."""
    return float(10.0 ** (sense * _DECIBELS * a / 20.0))


def gains(a, form, sense, shares, way="", **numbers):
    """Read channels with a wrong gain, the same all the time."""
    change = _GAINS[way or form]
    return _on_channels(a, shares, lambda *run: change(*run, a=a, sense=sense, **numbers))


def _each_run(x, share, _rate, rng, *, a, sense):
    """Read with another factor in each recording: a switch of ranges, a microphone moved."""
    spread = sense * 0.6 * _DECIBELS / 20.0 * np.log(10.0) * a
    return x * np.exp(spread * share * np.clip(rng.standard_normal(), -2.0, 2.0))


def _tilted(x, share, rate, _rng, *, a, sense, corner, steep, rising):
    """Let the error grow or fall with frequency, by no simple filter."""
    error = _factor(sense, 0.8 * a) - 1.0
    ratio = np.maximum(np.fft.rfftfreq(x.size, 1.0 / rate), 1.0) / corner
    mirrored = np.fft.rfft(x - x.mean()) * (1.0 / (1.0 + ratio ** (rising * steep)))
    return x + share * error * np.fft.irfft(mirrored, x.size)


def _equalised(x, share, rate, _rng, *, a, places, wide, levels, **_drawn):
    """Let the gain go up and down over frequency, as a poor response correction does."""
    levels = 0.8 * _DECIBELS / 20.0 * np.log(10.0) * a * levels
    levels[0] = abs(levels).max()
    frequency = np.maximum(np.fft.rfftfreq(x.size, 1.0 / rate), 1.0)
    octaves = np.log2(frequency[:, None] / places) / wide
    gain = np.exp(share * (levels * np.exp(-0.5 * octaves**2)).sum(axis=1))
    return x.mean() + np.fft.irfft(gain * np.fft.rfft(x - x.mean()), x.size)


def _blended(x, share, rate, _rng, *, a, corner, order, kind, **_drawn):
    """Blend in what a filter of first or second order leaves."""
    return x + a * share * (_filtered(x, *butter(order, min(2.0 * corner / rate, 0.9), kind)) - x)


def _bent(x, share, _rate, _rng, *, a, error, power, swings, **_drawn):
    """Let the gain depend on the reading, or on its swing about the mean."""
    centre = float(x.mean()) if swings else 0.0
    y = x - centre
    peak = float(np.abs(y).max()) or 1.0
    return centre + y * (1.0 + error * a * share * (np.abs(y) / peak) ** power)


def _one_sided(x, share, _rate, _rng, *, a, sense, above):
    """Read what is above the mean with another gain than what is below."""
    y = x - x.mean()
    return x + (_factor(sense, 0.7 * a) ** share - 1.0) * y * ((y > 0.0) == above)


_GAINS = {
    "decibels": lambda x, share, _rate, _rng, a, sense: _factor(sense, a) ** share * x,
    "mixed": lambda x, share, _rate, _rng, a, sense: np.exp(np.log(_factor(sense, a)) * share) * x,
    "each_run": _each_run, "tilted": _tilted, "equalised": _equalised, "filtered": _blended,
    "bent": _bent, "one_sided": _one_sided,
}  # fmt: skip


def varying_gains(a, form, sense, shares, **numbers):
    """Let a gain be wrong by more or less over time."""
    error = _factor(sense, 0.7 * a) - 1.0
    return _on_channels(a, shares, lambda x, share, *run: x * np.maximum(
        1.0 + error * share * _COURSES[form](x.size, *run, **numbers), 0.02))  # fmt: skip


def delays(a, form, latest, shares, **numbers):
    """Let channels come late by more or less over time."""
    course = _LATE.get(form) or _COURSES[form]

    def change(x, share, rate, rng):
        late = course(x.size, rate, rng, **numbers)
        when = np.arange(x.size) - share * (a * latest) * rate * late
        return np.interp(when, np.arange(x.size), x)

    return _on_channels(a, shares, change)


def _settling(n, rate, _rng, time, sign):
    gone = np.exp(-np.arange(n) / (time * rate))
    return gone if sign else 1.0 - gone


def _stepping(n, _rate, rng, later=1):
    """Change once, somewhere in the recording."""
    return np.where((np.arange(n) >= int(n * rng.uniform(0.1, 0.9))) == later, 1.0, 0.0)


_COURSES = {
    "wandering": lambda n, rate, rng, corner, mean: mean + 0.7 * slowly(rng, n, rate, corner),
    "switching": lambda n, rate, rng, often: 0.5 + 0.5 * telegraph(rng, n, rate, often),
    "stepping": _stepping,
    "settling": _settling,
}


def _packets(n, rate, rng, length):
    late = rng.exponential(0.7, math.ceil(n / (length * rate)) + 1)
    return late[(np.arange(n) / (length * rate)).astype(np.int64)]


def _late_start(n, _rate, rng, sides):
    """Start each recording by another delay: a trigger that is late by chance."""
    late = rng.normal() if sides else rng.exponential()
    return np.full(n, float(np.sign(late) * max(abs(late), 0.2)))


def _swinging(n, rate, rng, frequency, mean):
    """Swing about a delay: a tape, a phase-locked loop."""
    return mean + 0.7 * np.sin(2.0 * np.pi * (frequency * np.arange(n) / rate + rng.random()))


_LATE = {
    "packets": _packets, "each_run": _late_start, "step": _stepping, "swinging": _swinging,
    "corrected": lambda n, rate, rng, length: (
        np.arange(n) / (length * rate) + rng.random()) % 1.0,
}  # fmt: skip
"""A buffer lost once (step), two clocks that are made to agree again and again (corrected)."""


def lost_packets(a, size, repeated, mean, shares):
    """Lose packets: the one before is read again, or silence."""

    def change(x, share, rate, rng):
        length, at = max(2, round(size * rate)), np.arange(x.size)
        lost = (rng.random(x.size // length + 1) < 0.5 * a * abs(share))[at // length]
        late = np.interp(at - share * (a * mean) * rate, at, x)
        again = late[np.maximum(at - length, 0)]
        return np.where(lost, repeated * again + (1.0 - repeated) * x.mean(), late)

    return _on_channels(a, shares, change)


def dispersive(a, latest, corner, steep, way, shares):
    """Delay by an amount that depends on frequency, all levels being as they were."""

    def change(x, share, rate, _rng):
        n = 2 * x.size
        frequency = np.fft.rfftfreq(n, 1.0 / rate)
        group = a * latest / (1.0 + (np.maximum(frequency, 1.0) / corner) ** (way * steep))
        phase = 2.0 * np.pi * np.cumsum(group) * frequency[1]
        turned = np.fft.rfft(np.concatenate([x, x[::-1]])) * np.exp(-1j * share * phase)
        return np.fft.irfft(turned, n)[: x.size]

    return _on_channels(a, shares, change)


def whole_delay(a, latest, shares):
    """Come late by a constant, read exactly: two front-ends, a wireless link."""

    def change(x, share, rate, _rng):
        when = np.clip(np.arange(x.size) - share * (a * latest) * rate, 0.0, x.size - 1.0)
        return map_coordinates(x, [when], order=3, mode="mirror")

    return _on_channels(a, shares, change)


def mounts(a, form, shares, way="", **numbers):
    """Take away what the mount does not pass."""
    lost = _MOUNTS[way or form]
    return _on_channels(
        a, shares, lambda x, share, rate, _rng: x - a * share * lost(x, rate, **numbers)
    )


def _filtered(x, b, c):
    return lfilter(b, c, x, zi=lfilter_zi(b, c) * x[0])[0]


def _mode(x, rate, frequency, damping, numerator):
    """Filter by a mode, with a numerator in falling powers of s / omega."""
    tuned = 0.5 / math.tan(math.pi * min(frequency / rate, 0.45))
    return _filtered(x, *bilinear(numerator, [1.0, 2.0 * damping, 1.0], fs=tuned))


def _moving(x, rate, frequency, damping):
    """Relative motion of a mode below its base, of gain 1 far above: a stud's, a magnet's."""
    return _mode(x, rate, frequency, damping, [1.0, 0.0, 0.0])


def _several(x, rate, n, frequency, damping, parts):
    modes = zip(frequency.tolist(), damping.tolist(), parts.tolist(), strict=True)
    return sum(part * _moving(x, rate, f, d) for f, d, part in list(modes)[:n])


def _cascade(x, rate, frequency, second, damping, second_damping):
    base = x - _moving(x, rate, frequency, damping)
    return x - (base - _moving(base, rate, second, second_damping))


def _absorbing(x, rate, frequency, damping):
    """Swallow a band rather than ring in it, as a cable or a putty does."""
    return _mode(x, rate, frequency, damping, [0.0, 2.0 * damping, 0.0])


def _soft(x, rate, corner, order):
    return x - _filtered(x, *butter(order, 2.0 * min(corner, 0.45 * rate) / rate))


def _lifting(x, rate, frequency, damping, level):
    """Lift off where the motion pulls: what is beyond a level is read as a ringing less."""
    over = np.maximum(x - level * x.std() - x.mean(), 0.0)
    return over + _moving(over, rate, frequency, damping)


_MOUNTS = {
    "moving": _moving, "several": _several, "cascade": _cascade, "absorbing": _absorbing,
    "soft": _soft, "lifting": _lifting,
    "peak": lambda x, rate, frequency, damping, peak: -peak * _absorbing(
        x, rate, frequency, damping),
}  # fmt: skip
"""A peak does not lose what lies above: a bracket beside the sensor."""


def clips(a, form, shares, **numbers):
    """Limit a channel over its peak: ``limited(x / peak, cut, rate)``."""

    def change(x, share, rate, _rng):
        peak = float(np.abs(x).max())
        if peak == 0.0:
            return x
        cut = _DEEPEST * a * share * (1.0 - abs(float(x.mean())) / peak)
        return peak * _CLIPS[form](x / peak, cut, rate, **numbers)

    return _on_channels(a, shares, change)


def _polynomial(x, cut, _rate, power):
    # Rising as far as 1: of what a higher cut asks beyond, the rest is cut hard.
    y = x * (1.0 - min(cut, 1.0 / (power + 1.0)) * np.abs(x) ** power)
    return np.clip(y, cut - 1.0, 1.0 - cut)


def _wrapped(x, cut, _rate):
    limit = 1.0 - cut
    return np.where(np.abs(x) > limit, (x + limit) % (2.0 * limit) - limit, x)


def _folded(x, cut, _rate, back):
    over = np.maximum(np.abs(x) - (1.0 - cut), 0.0)
    return np.sign(x) * (np.minimum(np.abs(x), 1.0 - cut) - back * over)


def _bent_table(x, cut, _rate, shape):
    # True up to a knee, from there by a random curve to the peak's reading.
    size, knee = np.abs(x), max(1.0 - 2.0 * cut, 0.2)
    above = np.interp(
        (size - knee) / (1.0 - knee), np.linspace(0.0, 1.0, shape.size - 1), shape[1:]
    )
    top = max(1.0 - cut - knee, 0.0)
    bent = np.minimum(size, min(knee, 1.0 - cut)) + np.where(size > knee, top * above, 0.0)
    return np.sign(x) * (bent if cut > 0.0 else size)


_CLIPS = {
    "polynomial": _polynomial, "wrapped": _wrapped, "folded": _folded, "table": _bent_table,
    "recovering": lambda x, cut, rate, time, deep: droop(
        np.ascontiguousarray(x), 1.0 - cut, deep, 1.0 / (time * rate)),
}  # fmt: skip


def limits(a, form, shares, **numbers):
    """Limit the swing about the mean, over its peak: ``limited(y, limit, rate, rng)``."""

    def change(x, share, rate, rng):
        mean = float(x.mean())
        peak = float(np.abs(x - mean).max()) or 1.0
        limit = 1.0 - _DEEPEST * a * share
        return mean + peak * _LIMITS[form]((x - mean) / peak, limit, rate, rng, **numbers)

    return _on_channels(a, shares, change)


def _one_side(y, limit, _rate, _rng, above):
    side = limit * float(y.max() if above else -y.min())
    return np.minimum(y, side) if above else np.maximum(y, -side)


def _saturating(y, limit, _rate, _rng, p):
    """Saturate by any sharpness from a valve's to a rail's: y / (1 + |y / L|^p)^(1/p)."""
    if limit >= 1.0:
        return y
    rail = limit / (1.0 - limit**p) ** (1.0 / p)  # so that the peak reads the limit
    return y / (1.0 + np.abs(y / rail) ** p) ** (1.0 / p)


def _limit_filtered(y, limit, rate, _rng, order, corner):
    """Clip before a filter, which rounds the corners and lets them ring."""
    b, c = butter(order, min(2.0 * corner / rate, 0.9))
    return y - lfilter(b, c, y - np.clip(y, -limit, limit))


def _some_runs(y, limit, _rate, rng):
    """Clip some recordings more than others, as one range does for all."""
    own = 1.0 - (1.0 - limit) * float(rng.uniform(0.0, 1.0)) ** 0.5
    return np.clip(y, -own, own)


def _compressed(y, limit, _rate, _rng, slope):
    """Go on above the limit with a smaller slope: a compressor, a sensor beyond its range."""
    return y - np.sign(y) * (1.0 - slope) * np.maximum(np.abs(y) - limit, 0.0)


_LIMITS = {
    "swings": lambda y, limit, _rate, _rng: np.clip(y, -limit, limit),
    "unequal": lambda y, limit, _rate, _rng, other: np.clip(
        y, -(1.0 - other * (1.0 - limit)), limit),
    "crossover": lambda y, limit, _rate, _rng: (
        np.sign(y) * np.maximum(np.abs(y) - 0.3 * (1.0 - limit), 0.0)),
    "one_side": _one_side, "saturating": _saturating, "filtered": _limit_filtered,
    "some_runs": _some_runs, "compressed": _compressed,
}  # fmt: skip
"""Both sides of a signal coupled for alternating current, a supply that is not symmetrical,
nothing near zero (a sticky pen, a noise gate)."""


def clipped_reading(a, shares):
    """Clip the reading itself, mean and all: a torque beyond its range is a flat line."""

    def change(x, share, _rate, _rng):
        limit = (1.0 - 0.85 * a * share) * float(np.abs(x).max())
        return np.clip(x, -limit, limit)

    return _on_channels(a, shares, change)
