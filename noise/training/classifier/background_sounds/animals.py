"""Animals: dogs, roosters, pigs, cows, frogs, cats, hens, sheep, crows; insects and birds.

What tells a throat's call from a squeal: a pitch that glides by octaves within a call, formants
that stay while it does, many harmonics, a call's own envelope. What tells a rough one from a squawk
or a creak: periods that double and break, and noise in time with them.

A cricket's chirp is a train of pulses of one carrier, 2 to 8 kHz, each the stroke of a wing: its
carrier is as pure as a squeal's but comes in pulses of 10 to 30 ms, three to five a chirp, or
without end. A bird's whistle is as pure too, but sweeps.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from noise.training.classifier.background_sounds.building import (
    arch,
    harmonics,
    placed,
    repeated,
    resonance,
    voiced,
    wavering,
)
from noise.training.draws import coloured_noise, log_uniform, wandering


def _glide(m: int, low: float, high: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw a pitch between `low` and `high` [Hz] that arches, rises or falls by up to an octave."""
    x = np.linspace(0.0, 1.0, m)
    f0 = log_uniform(low, high, rng)
    size = 1.0 if rng.random() < 0.6 else 0.2  # some calls hold their pitch
    peak = rng.uniform(0.1, 0.6)
    shape = np.where(
        x < peak, np.sin(0.5 * np.pi * x / peak), np.cos(0.5 * np.pi * (x - peak) / (1.0 - peak))
    )
    return np.asarray(
        f0 * np.exp2(size * (rng.uniform(-0.15, 1.0) * shape + rng.uniform(-0.5, 0.3) * (x - 0.5)))
    )


def _call(
    m: int,
    rate: float,
    rng: np.random.Generator,
    *,
    pitch: tuple[float, float],
    formants: tuple[float, ...],
    roughness: tuple[float, float] = (0.0, 0.3),
    breath: tuple[float, float] = (0.02, 0.4),
    attack: float = 0.15,
) -> NDArray[np.float64]:
    course = _glide(m, *pitch, rng)
    sound = voiced(
        m,
        rate,
        course,
        formants,
        rng,
        roughness=rng.uniform(*roughness),
        breath=rng.uniform(*breath),
    )
    return np.asarray(sound * arch(m, rng, attack))


def _calls(
    n: int,
    rate: float,
    rng: np.random.Generator,
    lengths: tuple[float, float],
    gaps: tuple[float, float],
    **call: Any,
) -> NDArray[np.float64]:
    """Draw calls one after the other, each as `_call` makes it."""
    return repeated(n, rate, lengths, gaps, partial(_call, rate=rate, rng=rng, **call), rng)


def dog(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Barks, yaps, whines and growls."""
    size = log_uniform(0.6, 2.2, rng)
    formants = tuple(size * f for f in (600.0, 1300.0, 2400.0))
    kind = rng.random()
    if kind < 0.7:
        low = log_uniform(150.0, 900.0, rng)
        return _calls(n, rate, rng, (0.07, 0.35), (0.05, 0.8), pitch=(low, 1.4 * low),
                      formants=formants, roughness=(0.0, 1.0), breath=(0.05, 1.0), attack=0.08,
        )  # fmt: skip
    if kind < 0.85:  # a whine
        return _calls(
            n, rate, rng, (0.2, 1.2), (0.1, 0.8), pitch=(500.0, 1800.0), formants=formants
        )  # fmt: skip
    return _calls(n, rate, rng, (0.4, 1.5), (0.1, 0.4), pitch=(40.0, 120.0), formants=formants,
                  roughness=(0.4, 1.0))  # fmt: skip


def rooster(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Crowing: three or four syllables, the last but one long and highest."""
    top = log_uniform(400.0, 1300.0, rng)
    formants = tuple(rng.uniform(0.8, 1.3) * f for f in (1100.0, 2300.0, 3600.0))
    return _calls(n, rate, rng, (0.12, 1.1), (0.02, 0.15), pitch=(0.7 * top, top),
                  formants=formants, roughness=(0.0, 0.8), breath=(0.02, 0.3))  # fmt: skip


def pig(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Grunts, rough and low, and squeals, rough and high."""
    if rng.random() < 0.6:
        return _calls(
            n, rate, rng, (0.1, 0.6), (0.03, 0.5), pitch=(35.0, 180.0),
            formants=(400.0, 1100.0, 2200.0), roughness=(0.4, 1.2), breath=(0.3, 2.0),
        )  # fmt: skip
    return _calls(
        n, rate, rng, (0.25, 1.5), (0.05, 0.4), pitch=(500.0, 1600.0),
        formants=(1500.0, 2800.0, 4000.0), roughness=(0.3, 1.0), breath=(0.1, 0.8),
    )  # fmt: skip


def cow(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Mooing."""
    return _calls(n, rate, rng, (0.6, 2.5), (0.2, 1.0), pitch=(70.0, 280.0),
                  formants=(350.0, 800.0, 2000.0), roughness=(0.0, 0.7), attack=0.3)  # fmt: skip


def sheep(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Bleating: a voice that trembles 5 to 14 times a second."""

    def bleat(m: int) -> NDArray[np.float64]:
        tremble = np.sin(2 * np.pi * rng.uniform(5.0, 14.0) * np.arange(m) / rate + rng.random())
        course = log_uniform(120.0, 600.0, rng) * np.exp2(0.1 * rng.random() * tremble)
        course = course * wavering(m, rate, 2.0, 0.15, rng)
        sound = voiced(
            m, rate, course, (700.0, 1600.0, 2700.0), rng, roughness=rng.uniform(0.0, 0.7),
            breath=rng.uniform(0.05, 0.4),
        )  # fmt: skip
        return np.asarray(sound * (1.0 + rng.uniform(0.2, 0.9) * tremble) * arch(m, rng))

    return repeated(n, rate, (0.4, 1.5), (0.1, 1.0), bleat, rng)


def cat(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Meowing, at times hissing or purring."""
    if rng.random() < 0.12:
        beats = rng.uniform(20.0, 30.0)
        return _calls(n, rate, rng, (0.4, 1.2), (0.02, 0.1), pitch=(beats, beats * 1.1),
                      formants=(200.0, 600.0, 1500.0), breath=(0.5, 2.0))  # fmt: skip
    return _calls(n, rate, rng, (0.3, 1.6), (0.1, 1.0), pitch=(300.0, 1000.0),
                  formants=(900.0, 1800.0, 3500.0), roughness=(0.0, 0.5), attack=0.3)  # fmt: skip


def hen(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Clucking: short calls in series, now and then a long one."""
    top = log_uniform(300.0, 1000.0, rng)

    def cluck(m: int) -> NDArray[np.float64]:
        longer = int(m * (1.0 if rng.random() < 0.8 else 4.0))
        return _call(
            longer, rate, rng, pitch=(0.8 * top, 1.2 * top), formants=(1000.0, 2200.0, 3500.0),
            roughness=(0.1, 0.9), breath=(0.05, 0.8),
        )  # fmt: skip

    return repeated(n, rate, (0.04, 0.18), (0.06, 0.5), cluck, rng)


def crow(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Cawing: harsh calls of 0.2 to 0.6 s."""
    low = log_uniform(200.0, 800.0, rng)
    return _calls(
        n, rate, rng, (0.15, 0.6), (0.05, 0.8), pitch=(low, 1.2 * low),
        formants=(1200.0, 1900.0, 3200.0), roughness=(0.4, 1.4), breath=(0.1, 1.0),
    )  # fmt: skip


def frog(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Croaking: each croak a train of pulses of the throat's sac; or a chorus of peeps."""
    centre = log_uniform(250.0, 3500.0, rng)
    pace = log_uniform(15.0, 180.0, rng)

    def croak(m: int) -> NDArray[np.float64]:
        period = 1.0 / (pace * rng.uniform(0.9, 1.1))
        times = np.arange(0.0, m / rate, period)
        times = times + rng.normal(0.0, rng.uniform(0.0, 0.08) * period, times.size)
        hits = placed(m, times, rng.uniform(0.7, 1.3, times.size), rate)
        sound = resonance(hits, centre, rng.uniform(80.0, 400.0), rate)
        sound += rng.uniform(0.0, 0.7) * resonance(hits, 2.2 * centre, 300.0, rate)
        sound *= arch(m, rng, 0.4)
        return np.asarray(sound / (np.abs(sound).max() + 1e-300))

    sound = repeated(n, rate, (0.08, 0.9), (0.05, 0.8), croak, rng)
    for _ in range(int(rng.integers(0, 4))):
        centre, pace = log_uniform(250.0, 3500.0, rng), log_uniform(15.0, 180.0, rng)
        sound += rng.uniform(0.1, 0.8) * repeated(n, rate, (0.08, 0.9), (0.05, 0.8), croak, rng)
    return sound


def crickets(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """One to six crickets, each with its carrier, pulses and chirps; some trill without end."""
    sound = np.zeros(n)
    for i in range(int(rng.integers(1, 7))):
        one = chirping(
            n,
            rate,
            carrier=log_uniform(2000.0, min(8000.0, 0.4 * rate), rng),
            pulses_a_second=rng.uniform(18.0, 90.0),
            pulses_a_chirp=int(rng.integers(2, 7)) if rng.random() < 0.65 else 10_000,
            chirps_a_second=rng.uniform(1.0, 5.0),
            rng=rng,
        )
        sound += one * (1.0 if i == 0 else rng.uniform(0.02, 0.7))
    return sound


def chirping(
    n: int,
    rate: float,
    *,
    carrier: float,
    pulses_a_second: float,
    pulses_a_chirp: int,
    chirps_a_second: float,
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """One cricket.

    Examples
    --------
    >>> song = chirping(4800, 48e3, carrier=4e3, pulses_a_second=30.0, pulses_a_chirp=3,
    ...                 chirps_a_second=2.0, rng=np.random.default_rng(0))
    >>> song.shape
    (4800,)
    """
    time = np.arange(n) / rate + rng.random()
    pulse = time * pulses_a_second
    place = pulse % 1.0
    duty = rng.uniform(0.35, 0.85)
    inside = np.where(place < duty, np.sin(np.pi * place / duty), 0.0) ** rng.uniform(0.5, 1.5)
    period = max(1, round(pulses_a_second / chirps_a_second))
    if pulses_a_chirp < period:
        inside = inside * ((pulse.astype(int) % period) < pulses_a_chirp)
    sag = 1.0 - rng.uniform(0.0, 0.04) * place
    phase = 2 * np.pi * np.cumsum(carrier * sag * wavering(n, rate, 3.0, 0.004, rng)) / rate
    song = np.sin(phase) + rng.uniform(0.0, 0.15) * np.sin(2.0 * phase) * (carrier < 0.2 * rate)
    return np.asarray(song * inside * wavering(n, rate, 4.0, 0.3, rng))


def cicada(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw a band of noise at 3 to 9 kHz that buzzes some hundred times a second, and swells."""
    time = np.arange(n) / rate
    buzz = 1.0 + rng.uniform(0.2, 1.0) * np.sin(2 * np.pi * rng.uniform(60.0, 400.0) * time)
    noise = resonance(rng.standard_normal(n), rng.uniform(3e3, min(9e3, 0.4 * rate)),
                      rng.uniform(200.0, 2500.0), rate)  # fmt: skip
    swell = 1.0 + rng.uniform(0.0, 0.95) * wandering(n, rate, rng.uniform(0.5, 4.0), rng)
    return np.asarray(noise / noise.std() * buzz * swell)


def fly(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Flies, bees, mosquitoes: wings of 100 to 700 beats a second that come near and pass."""
    beats = log_uniform(100.0, 700.0, rng)
    bend = rng.uniform(0.02, 0.2) * wandering(n, rate, rng.uniform(0.7, 6.0), rng)
    sound = harmonics(beats * np.exp(bend), rate, rng.uniform(0.5, 1.5), n_most=25)
    loud = np.exp(rng.uniform(0.3, 2.0) * wandering(n, rate, rng.uniform(0.5, 6.0), rng))
    flutter = 1.0 + rng.uniform(0.0, 0.5) * coloured_noise(n, 1.0, rng)
    return np.asarray(sound * loud * flutter)


def birds(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """One to three birds: whistled sweeps, trills, or harsh twitter."""
    sound = np.zeros(n)
    for i in range(int(rng.integers(1, 4))):
        low = log_uniform(1000.0, min(6500.0, 0.3 * rate), rng)
        fast, harsh = rng.random() < 0.4, rng.random() < 0.25

        def note(
            m: int, low: float = low, fast: bool = fast, harsh: bool = harsh
        ) -> NDArray[np.float64]:
            x = np.linspace(0.0, 1.0, m)
            bend = rng.uniform(-0.8, 0.8) * x + rng.uniform(-0.5, 0.5) * np.sin(np.pi * x)
            if fast or rng.random() < 0.3:
                trill = rng.uniform(15.0, 60.0)
                bend = bend + rng.uniform(0.02, 0.3) * np.sin(2 * np.pi * trill * x * m / rate)
            pitch = np.clip(low * np.exp2(bend), 500.0, 0.45 * rate)
            if harsh:
                call = voiced(m, rate, 0.5 * pitch, (low, 1.7 * low), rng, roughness=0.7)
            else:
                call = harmonics(pitch, rate, rng.uniform(2.0, 5.0), n_most=4)
            return np.asarray(call * arch(m, rng, 0.3))

        lengths = (0.03, 0.15) if fast else (0.06, 0.6)
        part = repeated(n, rate, lengths, (0.01, 0.6), note, rng)
        sound += part * (1.0 if i == 0 else rng.uniform(0.05, 0.7))
    return sound


RECIPES = (birds, cat, cicada, cow, crickets, crow, dog, fly, frog, hen, pig, rooster, sheep)
"""Each takes the number of samples, the rate [Hz] and a generator."""
