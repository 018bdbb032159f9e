"""Further forms of channels that are misread: gains, limits, delays and mounts."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import bilinear, butter, lfilter, lfilter_zi

from noise.diagnosis.cases.variants.common import (
    Array,
    Recipe,
    Rng,
    draw_shares,
    drawn_curve,
    log_uniform,
    log_uniforms,
    on_sensors,
    telegraph,
    wander,
)  # fmt: skip
from noise.diagnosis.cases.variants.limits import droop

if TYPE_CHECKING:
    from sim.effects.effect import Effect

__all__ = ["CLIPPING", "DELAY", "GAIN", "MOUNT"]
TimeSeries = Callable[[int, float, Rng], Array]


def _slowly(rng: Rng, n: int, rate: float, corner: float) -> Array:
    coarse = max(1, int(rate / (20.0 * corner)))
    slow = wander(rng, n // coarse + 2, rate / coarse, corner)
    return np.interp(np.arange(n), coarse * np.arange(slow.size), slow)


def _gains(form: str, a: float, rng: Rng, time_series: TimeSeries) -> Effect:
    error = float(rng.choice([-0.5, 0.8])) * a

    def change(x: Array, share: float, rate: float, rng: Rng) -> Array:
        return np.asarray(
            x * np.maximum(1.0 + error * share * time_series(x.size, rate, rng), 0.02)
        )

    return on_sensors("gain_error", form, a, draw_shares(rng), change)


def _gain_wandering(a: float, rng: Rng) -> Effect:
    corner, mean = log_uniform(rng, 0.5, 15.0), float(rng.uniform(0.0, 1.0))
    return _gains(
        "wandering", a, rng, lambda n, rate, rng: mean + 0.7 * _slowly(rng, n, rate, corner)
    )


def _gain_switching(a: float, rng: Rng) -> Effect:
    often = log_uniform(rng, 3.0, 40.0)
    return _gains(
        "switching", a, rng, lambda n, rate, rng: 0.5 + 0.5 * telegraph(rng, n, rate, often)
    )


def _gain_settling(a: float, rng: Rng) -> Effect:
    time, sign = log_uniform(rng, 0.02, 0.5), bool(rng.integers(2))

    def time_series(n: int, rate: float, _rng: Rng) -> Array:
        gone = np.exp(-np.arange(n) / (time * rate))
        return gone if sign else 1.0 - gone

    return _gains("settling", a, rng, time_series)


def _gain_tilted(a: float, rng: Rng) -> Effect:
    """Let the error grow or fall with frequency, by no simple filter."""
    error = float(rng.choice([-0.5, 0.8])) * a
    corner, steep = log_uniform(rng, 150.0, 3000.0), float(rng.uniform(0.3, 3.0))
    way = float(rng.choice([-1.0, 1.0]))

    def change(x: Array, share: float, rate: float, _rng: Rng) -> Array:
        ratio = np.maximum(np.fft.rfftfreq(x.size, 1.0 / rate), 1.0) / corner
        wrong = 1.0 / (1.0 + ratio ** (way * steep))
        mirrored = np.fft.rfft(x - x.mean()) * wrong
        return np.asarray(x + share * error * np.fft.irfft(mirrored, x.size))

    return on_sensors("gain_error", "tilted", a, draw_shares(rng), change)


def _clips(
    form: str, a: float, rng: Rng, limited: Callable[[Array, float, float], Array]
) -> Effect:
    """Limit a channel over its peak: ``limited(x / peak, cut, rate)``."""

    def change(x: Array, share: float, rate: float, _rng: Rng) -> Array:
        peak = float(np.abs(x).max())
        if peak == 0.0:
            return x
        cut = 0.75 * a * share * (1.0 - abs(float(x.mean())) / peak)
        return np.asarray(peak * limited(x / peak, cut, rate))

    return on_sensors("clipping", form, a, draw_shares(rng), change)


def _clip_polynomial(a: float, rng: Rng) -> Effect:
    power = float(rng.uniform(1.5, 6.0))
    # Rising as far as 1: of what a higher cut asks beyond, the rest is cut hard.
    most = 1.0 / (power + 1.0)

    def limited(x: Array, cut: float, _rate: float) -> Array:
        bent = min(cut, most)
        y = x * (1.0 - bent * np.abs(x) ** power)
        return np.asarray(np.clip(y, cut - 1.0, 1.0 - cut))

    return _clips("polynomial", a, rng, limited)


def _clip_wrapped(a: float, rng: Rng) -> Effect:
    def limited(x: Array, cut: float, _rate: float) -> Array:
        limit = 1.0 - cut
        over = np.abs(x) > limit
        return np.where(over, (x + limit) % (2.0 * limit) - limit, x)

    return _clips("wrapped", a, rng, limited)


def _clip_folded(a: float, rng: Rng) -> Effect:
    back = float(rng.uniform(0.3, 1.0))

    def limited(x: Array, cut: float, _rate: float) -> Array:
        over = np.maximum(np.abs(x) - (1.0 - cut), 0.0)
        return np.asarray(np.sign(x) * (np.minimum(np.abs(x), 1.0 - cut) - back * over))

    return _clips("folded", a, rng, limited)


def _clip_recovering(a: float, rng: Rng) -> Effect:
    time, deep = log_uniform(rng, 1e-4, 0.02), float(rng.uniform(0.3, 1.0))

    def limited(x: Array, cut: float, rate: float) -> Array:
        return np.asarray(droop(np.ascontiguousarray(x), 1.0 - cut, deep, 1.0 / (time * rate)))

    return _clips("recovering", a, rng, limited)


def _clip_table(a: float, rng: Rng) -> Effect:
    shape = drawn_curve(rng)[1:]
    knots = np.linspace(0.0, 1.0, shape.size)

    def limited(x: Array, cut: float, _rate: float) -> Array:
        # True up to a knee, from there by a random time series to the peak's reading.
        size, knee = np.abs(x), max(1.0 - 2.0 * cut, 0.2)
        above = np.interp((size - knee) / (1.0 - knee), knots, shape)
        top = max(1.0 - cut - knee, 0.0)
        bent = np.minimum(size, min(knee, 1.0 - cut)) + np.where(size > knee, top * above, 0.0)
        return np.asarray(np.sign(x) * (bent if cut > 0.0 else size))

    return _clips("table", a, rng, limited)


def _delays(form: str, a: float, rng: Rng, time_series: TimeSeries) -> Effect:
    delay = a * log_uniform(rng, 5e-4, 3e-3)

    def change(x: Array, share: float, rate: float, rng: Rng) -> Array:
        when = np.arange(x.size) - share * delay * rate * time_series(x.size, rate, rng)
        return np.interp(when, np.arange(x.size), x)

    return on_sensors("channel_delay", form, a, draw_shares(rng, signed=True), change)


def _delay_packets(a: float, rng: Rng) -> Effect:
    length = log_uniform(rng, 2e-3, 0.05)

    def time_series(n: int, rate: float, rng: Rng) -> Array:
        late = rng.exponential(0.7, math.ceil(n / (length * rate)) + 1)
        return np.asarray(late[(np.arange(n) / (length * rate)).astype(np.int64)])

    return _delays("packets", a, rng, time_series)


def _delay_wandering(a: float, rng: Rng) -> Effect:
    corner, mean = log_uniform(rng, 0.5, 30.0), float(rng.uniform(0.0, 1.0))
    return _delays(
        "wandering", a, rng, lambda n, rate, rng: mean + 0.7 * _slowly(rng, n, rate, corner)
    )


def _delay_lost(a: float, rng: Rng) -> Effect:
    """Lose packets: the one before is read again, or silence."""
    size, kept = log_uniform(rng, 2e-3, 8e-3), float(rng.choice([0.0, 1.0]))
    chance, mean = 0.5 * a, a * log_uniform(rng, 3e-4, 1.5e-3)

    def change(x: Array, share: float, rate: float, rng: Rng) -> Array:
        length = max(2, round(size * rate))
        at = np.arange(x.size)
        lost = (rng.random(x.size // length + 1) < chance * abs(share))[at // length]
        late = np.interp(at - share * mean * rate, at, x)
        again = late[np.maximum(at - length, 0)]
        return np.asarray(np.where(lost, kept * again + (1.0 - kept) * x.mean(), late))

    return on_sensors("channel_delay", "lost_packets", a, draw_shares(rng, signed=True), change)


def _delay_dispersive(a: float, rng: Rng) -> Effect:
    """Delay by an amount that depends on frequency, all levels being kept."""
    delay, corner = a * log_uniform(rng, 5e-4, 3e-3), log_uniform(rng, 150.0, 3000.0)
    steep, way = float(rng.uniform(0.5, 3.0)), float(rng.choice([-1.0, 1.0]))

    def change(x: Array, share: float, rate: float, _rng: Rng) -> Array:
        n = 2 * x.size
        frequency = np.fft.rfftfreq(n, 1.0 / rate)
        group = delay / (1.0 + (np.maximum(frequency, 1.0) / corner) ** (way * steep))
        phase = 2.0 * np.pi * np.cumsum(group) * frequency[1]
        mirrored = np.concatenate([x, x[::-1]])
        return np.asarray(
            np.fft.irfft(np.fft.rfft(mirrored) * np.exp(-1j * share * phase), n)[: x.size]
        )

    return on_sensors("channel_delay", "dispersive", a, draw_shares(rng, signed=True), change)


def _mounts(form: str, a: float, rng: Rng, lost: Callable[[Array, float], Array]) -> Effect:
    """Take away what the mount does not pass: ``lost(x, rate)``."""
    mostly = ("acceleration",) if rng.random() < 0.7 else ("torque", "acceleration", "pressure")

    def change(x: Array, share: float, rate: float, _rng: Rng) -> Array:
        return np.asarray(x - a * share * lost(x, rate))

    return on_sensors("mount_resonance", form, a, draw_shares(rng, mostly), change)


def _filtered(x: Array, b: Array, c: Array) -> Array:
    return np.asarray(lfilter(b, c, x, zi=lfilter_zi(b, c) * x[0])[0])


def _moving(x: Array, rate: float, frequency: float, damping: float) -> Array:
    """Relative motion of a mode below its base, of gain 1 far above."""
    share = min(frequency / rate, 0.45)
    tuned = 0.5 / math.tan(math.pi * share)
    return _filtered(x, *bilinear([1.0, 0.0, 0.0], [1.0, 2.0 * damping, 1.0], fs=tuned))


def _mount_several(a: float, rng: Rng) -> Effect:
    n = int(rng.integers(3, 6))
    modes = log_uniforms(rng, 900.0, 12e3, n).tolist()
    dampings = log_uniforms(rng, 0.012, 0.15, n).tolist()
    parts = rng.dirichlet(np.full(n, 2.0)).tolist()
    listed = list(zip(modes, dampings, parts, strict=True))
    return _mounts(
        "several", a, rng,
        lambda x, rate: np.asarray(sum(part * _moving(x, rate, f, d) for f, d, part in listed)),
    )  # fmt: skip


def _mount_cascade(a: float, rng: Rng) -> Effect:
    first, second = log_uniform(rng, 900.0, 5000.0), log_uniform(rng, 3000.0, 12e3)
    dampings = [log_uniform(rng, 0.02, 0.2) for _ in range(2)]

    def lost(x: Array, rate: float) -> Array:
        base = x - _moving(x, rate, first, dampings[0])
        return np.asarray(x - (base - _moving(base, rate, second, dampings[1])))

    return _mounts("cascade", a, rng, lost)


def _mount_absorbing(a: float, rng: Rng) -> Effect:
    """Swallow a band rather than ring in it, as a cable or a putty does."""
    frequency, damping = log_uniform(rng, 900.0, 9000.0), log_uniform(rng, 0.1, 0.6)

    def lost(x: Array, rate: float) -> Array:
        share = min(frequency / rate, 0.45)
        tuned = 0.5 / math.tan(math.pi * share)
        band = bilinear([0.0, 2.0 * damping, 0.0], [1.0, 2.0 * damping, 1.0], fs=tuned)
        return _filtered(x, *band)

    return _mounts("absorbing", a, rng, lost)


def _mount_soft(a: float, rng: Rng) -> Effect:
    corner, order = log_uniform(rng, 900.0, 7000.0), int(rng.integers(1, 4))

    def lost(x: Array, rate: float) -> Array:
        return np.asarray(x - _filtered(x, *butter(order, 2.0 * min(corner, 0.45 * rate) / rate)))

    return _mounts("soft", a, rng, lost)


GAIN: tuple[Recipe, ...] = (_gain_wandering, _gain_switching, _gain_settling, _gain_tilted)
CLIPPING: tuple[Recipe, ...] = (
    _clip_polynomial, _clip_wrapped, _clip_folded, _clip_recovering, _clip_table,
)  # fmt: skip
DELAY: tuple[Recipe, ...] = (_delay_packets, _delay_wandering, _delay_lost, _delay_dispersive)
MOUNT: tuple[Recipe, ...] = (_mount_several, _mount_cascade, _mount_absorbing, _mount_soft)
