"""Noise of the places where engineers record, and mixing of a sound into a place.

Halls of test benches: a hydraulic pump has the rate of its pistons with many harmonics, modulated
by its shaft, and its valves hiss; fans have the rate of their blades; workshops have blows and
grinders.

Cabins of vehicles: road noise has most of its power below 500 Hz, a hump of tyres near 800 Hz and
the cavity of the tyre near 220 Hz. Wind falls more gently and has gusts. An engine fires once per
two turns and cylinder, with half orders; an electric motor has high orders of its shaft, and its
inverter a tone near 8 to 10 kHz.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft, rfftfreq
from scipy.ndimage import maximum_filter1d, minimum_filter1d
from scipy.signal import fftconvolve

from features.kernels.weighting import a_weighting
from noise.base import packaged_toml
from noise.base.arrays import Array, Rng
from noise.training.classifier.background_sounds import background_sound
from noise.training.classifier.synthesis import blow, placed, wavering
from noise.training.draws import coloured_noise, log_uniform, low_pass, picked, wandering


def in_a_room(sound: Array, rate: float, rng: Rng) -> Array:
    """Return a sound of the same length with random reflections and a tail.

    Examples
    --------
    >>> click = np.zeros(4800)
    >>> click[0] = 1.0
    >>> echoing = in_a_room(click, 48e3, np.random.default_rng(0))
    >>> echoing.shape, round(float(echoing[0]), 6)
    ((4800,), 1.0)
    """
    t60 = log_uniform(0.1, 1.2, rng)
    n = int(min(t60, 0.6) * rate)
    time = np.arange(n) / rate
    taps = rng.standard_normal(n) * 10.0 ** (-3.0 * time / t60)
    taps[: int(rng.uniform(0.002, 0.01) * rate)] = 0.0
    taps = low_pass(taps, rng.uniform(2e3, 12e3), rate)
    taps *= 10.0 ** (rng.uniform(-20.0, 0.0) / 20.0) / math.sqrt(float(np.sum(taps**2)))
    early = int(rng.integers(0, 9))
    if early:
        when = rng.uniform(0.001, 0.04, early)
        taps[np.minimum((when * rate).astype(int), n - 1)] += (
            rng.uniform(0.1, 0.7, early) * rng.choice((-1.0, 1.0), early) / (1.0 + 60.0 * when)
        )
    taps[0] = 1.0
    return np.asarray(fftconvolve(sound, taps)[: sound.size])


TABLE = packaged_toml("noise.training.classifier", "places.toml")
"""Spectra, cabins and microphones."""

CABINS: Mapping[str, Mapping[str, Any]] = TABLE["cabins"]
"""Families of cabins by name."""

_SPECTRA = TABLE["spectra"]


def cabin(kind: str, n: int, rate: float, rng: Rng) -> Array:
    """Return random noise of a family of cabins.

    Parameters
    ----------
    kind : str
        One of `CABINS`.
    n : int
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        Noise of unit standard deviation [-].

    Examples
    --------
    >>> sound = cabin("petrol_car", 4800, 48e3, np.random.default_rng(0))
    >>> sound.shape, round(float(sound.std()), 6)
    ((4800,), 1.0)
    """
    what = CABINS[kind]
    road = _road(n, rate, rng)
    wind = shaped_noise(n, rate, _SPECTRA["wind"], rng)
    wind *= np.exp(rng.uniform(0.0, 0.5) * wandering(n, rate, rng.uniform(0.3, 3.0), rng))
    fan = shaped_noise(n, rate, _SPECTRA["fan"], rng)
    slowest, fastest = what["turns"]
    turns = log_uniform(slowest, fastest, rng) * wavering(n, rate, 0.4, rng.uniform(0.0, 0.15), rng)
    cylinders = int(rng.choice(what["cylinders"]))
    roll_off = rng.uniform(*what["roll_off"])
    if cylinders:
        drive = orders(turns, rate, 0.5, 0.5 * cylinders, roll_off, rng)
    else:
        drive = orders(turns, rate, 4.0, float(rng.choice((24.0, 36.0, 48.0))), roll_off, rng)
        drive += 10.0 ** rng.uniform(-2.5, -0.5) * _inverter(turns, rate, rng)
    sound = np.zeros(n)
    for name, part in (("road", road), ("wind", wind), ("fan", fan), ("drive", drive)):
        sound += 10.0 ** (rng.uniform(*what[name]) / 20.0) * part / (part.std() + 1e-12)
    return np.asarray(sound / sound.std())


def shaped_noise(n: int, rate: float, shape: Sequence[tuple[float, float]], rng: Rng) -> Array:
    """Return noise with a spectrum of a given shape, with random deviations and a random tilt.

    Parameters
    ----------
    n : int
        Number of samples.
    rate : float
        [Hz]
    shape : sequence of pair of float
        Increasing frequencies [Hz], and spectral density [dB].
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        Of unit standard deviation [-].

    Examples
    --------
    >>> noise = shaped_noise(4800, 48e3, ((20, 0), (8000, -40)), np.random.default_rng(0))
    >>> round(float(noise.std()), 6)
    1.0
    """
    at, level = np.array(shape, dtype=np.float64).T
    octave = np.log2(at)
    level = level + rng.normal(0.0, 4.0, at.size)
    level += rng.uniform(-2.0, 2.0) * (octave - octave.mean())
    m = next_fast_len(n, real=True)
    frequency = np.maximum(rfftfreq(m, 1.0 / rate), 10.0)
    gain = 10.0 ** (np.interp(np.log2(frequency), octave, level) / 20.0)
    noise = irfft(rfft(rng.standard_normal(m)) * gain, m)[:n]
    return np.asarray(noise / noise.std())


def orders(
    turns: Array, rate: float, spacing: float, main: float, roll_off: float, rng: Rng
) -> Array:
    """Return random orders of a turning shaft; multiples of the main order are the strongest.

    Parameters
    ----------
    turns : ndarray, shape (n,)
        Speed of the shaft [1/s].
    rate : float
        [Hz]
    spacing, main : float
        Spacing of the orders, and order of firing, teeth or pistons [-].
    roll_off : float
        Exponent of the decrease of the amplitudes with the order [-].
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> sound = orders(np.full(4800, 25.0), 48e3, 0.5, 2.0, 1.0, np.random.default_rng(0))
    >>> sound.shape
    (4800,)
    """
    phase = 2.0 * np.pi * np.cumsum(turns) / rate
    sound = np.zeros(turns.size)
    weaker = rng.uniform(0.03, 0.4)
    numbers = np.unique(np.r_[spacing * np.arange(1, 9), main * np.arange(1, 16)])
    for number in numbers.tolist():
        if number * float(turns.max()) > 0.45 * rate:
            break
        strength = (number / main) ** -roll_off * rng.lognormal(0.0, 0.6)
        if number % main:
            strength *= weaker * min(1.0, (number / main) ** roll_off)
        sound += strength * np.sin(number * phase + rng.uniform(0.0, 6.3))
    return sound


def _road(n: int, rate: float, rng: Rng) -> Array:
    """Return noise of rolling on a rough surface, sometimes with joints."""
    sound = shaped_noise(n, rate, _SPECTRA["road"], rng)
    cavity = rng.uniform(190.0, 250.0)
    narrow = ((20, -60), (cavity / 1.2, -25), (cavity, 0), (1.2 * cavity, -25), (8000, -60))
    sound += rng.uniform(0.0, 0.5) * shaped_noise(n, rate, narrow, rng)
    rough = rng.uniform(0.0, 0.6) * wandering(n, rate, log_uniform(0.3, 10.0, rng), rng)
    sound *= np.exp(rough)
    if rng.random() < 0.25:  # joints pass the front axle, then the rear axle
        gap = rng.uniform(0.08, 0.25)
        times = np.arange(rng.random(), n / rate, rng.uniform(0.4, 1.5))
        joints = placed(n, np.r_[times, times + gap], np.ones(2 * times.size), rate)
        thump = blow(rate, (40.0, 500.0), (0.01, 0.06), rng, noise=0.5)
        knocks = fftconvolve(joints, thump)[:n] if times.size else joints
        sound += log_uniform(1.0, 6.0, rng) * knocks / (np.abs(knocks).max() + 1e-12)
    return sound


def _inverter(turns: Array, rate: float, rng: Rng) -> Array:
    """Return a switching tone with sidebands at multiples of the electrical frequency."""
    carrier = rng.uniform(7e3, 10e3)
    phase = 2.0 * np.pi * np.cumsum(turns) / rate * float(rng.choice((3.0, 4.0)))
    time = np.arange(turns.size) / rate
    sound = np.zeros(turns.size)
    if carrier < 0.4 * rate:
        for side in (-4, -2, 0, 2, 4):
            angle = 2.0 * np.pi * carrier * time + side * phase + rng.uniform(0.0, 6.3)
            sound += rng.uniform(0.1, 1.0) * np.sin(angle)
    return sound


def hydraulic_hall(n: int, rate: float, rng: Rng) -> Array:
    """Return noise of axial piston pumps at mains speed, valves, and a fan."""
    sound = _air(n, rate, rng)
    for _ in range(int(rng.integers(1, 3))):
        # An asynchronous motor of two or four poles at 50 or 60 Hz
        mains = float(rng.choice((25.0, 30.0, 50.0, 60.0))) * rng.uniform(0.95, 0.995)
        turns = mains * wavering(n, rate, 0.3, 0.004, rng)
        pump = orders(
            turns, rate, 1.0, float(rng.choice((7.0, 9.0, 11.0))), rng.uniform(0.0, 1.2), rng
        )
        sound += 10.0 ** rng.uniform(-1.0, 0.6) * pump / pump.std()
    valves = 10.0 ** rng.uniform(-1.5, 0.0) * shaped_noise(n, rate, _SPECTRA["valves"], rng)
    return np.asarray(sound + valves)


def workshop(n: int, rate: float, rng: Rng) -> Array:
    """Return noise of ventilation, random blows, and a distant grinder or drill."""
    sound = _air(n, rate, rng)
    count = rng.poisson(rng.uniform(0.0, 3.0) * n / rate)
    if count:
        hits = placed(n, rng.uniform(0.0, n / rate, count), rng.lognormal(0.0, 0.7, count), rate)
        ring = blow(rate, (150.0, 5000.0), (0.005, 0.1), rng, noise=0.5)
        blows = fftconvolve(hits, ring)[:n]
        sound += rng.uniform(0.5, 4.0) * blows / (np.abs(blows).max() + 1e-12)
    if rng.random() < 0.4:
        turns = rng.uniform(60.0, 180.0) * wavering(n, rate, 1.0, 0.1, rng)
        tool = orders(turns, rate, 1.0, float(rng.integers(2, 9)), rng.uniform(0.3, 1.2), rng)
        tool = tool / tool.std() + 0.5 * shaped_noise(n, rate, _SPECTRA["valves"], rng)
        working = np.clip(2.0 * wandering(n, rate, 0.5, rng) + 0.5, 0.0, 1.0)
        sound += rng.uniform(0.02, 0.6) * working * tool
    return sound


def engine_cell(n: int, rate: float, rng: Rng) -> Array:
    """Return noise of an engine on a dynamometer behind glass, and strong ventilation."""
    turns = rng.uniform(13.0, 100.0) * wavering(n, rate, 0.3, 0.02, rng)
    firing = 0.5 * float(rng.choice((3, 4, 6, 8)))
    engine = orders(turns, rate, 0.5, firing, rng.uniform(0.3, 1.5), rng)
    return np.asarray(rng.uniform(0.3, 3.0) * engine / engine.std() + _air(n, rate, rng))


def laboratory(n: int, rate: float, rng: Rng) -> Array:
    """Return noise of computer fans and soft ventilation."""
    sound = _air(n, rate, rng)
    for _ in range(int(rng.integers(1, 4))):
        turns = rng.uniform(12.0, 80.0) * wavering(n, rate, 0.3, 0.01, rng)
        fan = orders(
            turns,
            rate,
            1.0,
            float(rng.choice((5.0, 7.0, 8.0, 9.0, 11.0))),
            rng.uniform(0.5, 2.0),
            rng,
        )
        sound += 10.0 ** rng.uniform(-1.6, -0.2) * fan / fan.std()
    return sound


def bench_with_a_motor(n: int, rate: float, rng: Rng) -> Array:
    """Return noise of the drive of a bench: a motor with a gear and an inverter."""
    turns = rng.uniform(2.0, 50.0) * wavering(n, rate, 0.5, 0.02, rng)
    gear = orders(turns, rate, 1.0, float(rng.integers(10, 40)), rng.uniform(0.5, 2.0), rng)
    whine = np.sin(2.0 * np.pi * rng.uniform(2e3, 0.4 * min(rate, 4e4)) * np.arange(n) / rate)
    sound = _air(n, rate, rng) + 10.0 ** rng.uniform(-1.0, 0.3) * gear / (gear.std() + 1e-12)
    return np.asarray(sound + (rng.random() < 0.4) * 10.0 ** rng.uniform(-2.0, -0.7) * whine)


def _air(n: int, rate: float, rng: Rng) -> Array:
    air = shaped_noise(n, rate, _SPECTRA["ventilation"], rng)
    return in_a_room(air, rate, rng) if rng.random() < 0.2 else air


HALLS: Mapping[str, Callable[[int, float, Rng], Array]] = {
    recipe.__name__: recipe
    for recipe in (hydraulic_hall, workshop, engine_cell, laboratory, bench_with_a_motor)
}
"""Halls by name: functions of the number of samples, the rate [Hz] and a generator."""


PLACES = (*CABINS, *HALLS)
"""Families of cabins and halls."""

_FRAME = 0.032
"""Duration of a frame [s]."""


def place(
    n: int, rate: float, rng: Rng, *, among: Sequence[str] = PLACES, peopled: bool = True
) -> Array:
    """Return random noise of a place.

    Parameters
    ----------
    n : int
    rate : float
        [Hz]
    rng : numpy.random.Generator
    among : sequence of str
        Families, of `PLACES`.
    peopled : bool
        Whether speech, music, a slamming door and an indicator are possible, each with a
        probability of 0.1; otherwise they are rare and faint.

    Returns
    -------
    ndarray, shape (n,)
        Of unit standard deviation [-].

    Examples
    --------
    >>> float(place(4800, 48e3, np.random.default_rng(1)).std().round(6))
    1.0
    """
    name = among[int(rng.integers(len(among)))]
    sound = HALLS[name](n, rate, rng) if name in HALLS else cabin(name, n, rate, rng)
    level = a_weighted(sound, rate).std()
    for event in ("speech", "music", "slam", "indicator"):
        if rng.random() < (0.1 if peopled else 0.04):
            other = background_sound(n, rate, rng, event, alone=True)
            own = a_weighted(other, rate).std()
            strength = rng.uniform(-15.0, 3.0) if peopled else rng.uniform(-25.0, -14.0)
            sound = sound + 10.0 ** (strength / 20.0) * level / (own + 1e-12) * other
    return np.asarray(sound / sound.std())


def in_a_place(
    sound: Array, surroundings: Array, rate: float, snr: float
) -> tuple[Array, tuple[float, float]]:
    """Return a sound mixed with the noise of a place, raised if it would be inaudible.

    Parameters
    ----------
    sound, surroundings : ndarray, shape (n,)
        [any one unit]
    rate : float
        [Hz]
    snr : float
        A-weighted level of the sound over that of the place [dB].

    Returns
    -------
    mixed : ndarray, shape (n,)
        [unit of `sound`]
    span : tuple of float
        Start and end of the longest audible part [s].

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> tone = np.sin(2 * np.pi * 1e3 * np.arange(24_000) / 48e3)
    >>> mixed, span = in_a_place(tone, place(24_000, 48e3, rng), 48e3, 0.0)
    >>> mixed.shape, span
    ((24000,), (0.0, 0.5))
    """
    weighted, around = a_weighted(sound, rate), a_weighted(surroundings, rate)
    level = float(weighted.std())
    if not level > 0.0:
        return surroundings, (0.0, sound.size / rate)
    share = level / (float(around.std()) + 1e-300) * 10.0 ** (-snr / 20.0)
    stands = _stands_out(weighted, share * around, rate)
    # Raised to 3 dB above the place, then further until half a second is audible.
    lift = max(0.0, 3.0 - float(np.quantile(stands, 0.95)))
    for more in (0.0, 10.0, 20.0, 40.0):
        span = _longest(stands + lift + more > 0.0, sound.size / rate)
        if span[1] - span[0] >= 0.5:
            break
    else:  # the sound itself has pauses
        span = (0.0, sound.size / rate)
    return sound + share * 10.0 ** (-(lift + more) / 20.0) * surroundings, span


def a_weighted(sound: Array, rate: float) -> Array:
    """Return an A-weighted sound.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        [any unit]
    rate : float
        [Hz]

    Returns
    -------
    ndarray, shape (n,)
        [unit of `sound`]

    Examples
    --------
    >>> tone = np.sin(2 * np.pi * 1e3 * np.arange(4800) / 48e3)
    >>> round(float(a_weighted(tone, 48e3).std() / tone.std()), 2)
    1.0
    """
    m = next_fast_len(sound.size, real=True)
    gain = 10.0 ** (a_weighting(np.maximum(rfftfreq(m, 1.0 / rate), 1.0)) / 20.0)
    return np.asarray(irfft(rfft(sound, m) * gain, m)[: sound.size])


def _stands_out(sound: Array, surroundings: Array, rate: float) -> Array:
    """Return the level of a sound above a place in its best half octave, by frame [dB].

    Pauses of the sound, 18 dB below its loudest frame, have -300 dB.
    """
    frame = round(_FRAME * rate)
    of_sound, around = (
        np.abs(np.fft.rfft(x[: x.size // frame * frame].reshape(-1, frame) * np.hanning(frame)))
        for x in (sound, surroundings)
    )
    edges = np.unique(
        np.minimum(
            np.round(160.0 * 2.0 ** (0.5 * np.arange(12)) * frame / rate).astype(int), frame // 2
        )
    )[:-1]
    power = np.add.reduceat(of_sound**2, edges, axis=1)
    mean = np.add.reduceat(around**2, edges, axis=1).mean(axis=0)
    stands = 10.0 * np.log10((power / (mean + 1e-300)).max(axis=1) + 1e-300)
    pause = power.sum(axis=1) < 10.0**-1.8 * power.sum(axis=1).max()
    return np.where(pause, -300.0, stands)


def _longest(sounds: NDArray[np.bool_], duration: float) -> tuple[float, float]:
    """Return start and end of the longest run of frames [s]; pauses of up to 0.3 s are closed.

    Blows of a creak are closer.
    """
    reach = 2 * round(0.15 / _FRAME) + 1
    closed = minimum_filter1d(maximum_filter1d(sounds.astype(int), reach), reach)
    edges = np.flatnonzero(np.diff(np.r_[0, closed, 0]))
    if not edges.size:
        return 0.0, duration
    starts, ends = edges[::2], edges[1::2]
    best = int((ends - starts).argmax())
    end = duration if ends[best] == sounds.size else int(ends[best]) * _FRAME
    return int(starts[best]) * _FRAME, end


def background(n: int, rate: float, rng: Rng) -> Array:
    """Return steady noise of a room, a cabin, a road or wind, of unit standard deviation.

    The noise of a cabin falls by 6 to 10 dB per octave, with weak engine orders; that of tyres has
    a hump at 150-1000 Hz; wind has low frequencies and gusts.

    Parameters
    ----------
    n : int
        Number of samples.
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> float(background(4800, 48e3, np.random.default_rng(1)).std().round(6))
    1.0
    """
    kind = rng.random()
    if kind < 0.5:
        return coloured_noise(n, rng.uniform(0.0, 2.0), rng)
    if kind < 0.7:
        noise = coloured_noise(n, rng.uniform(1.8, 3.2), rng)
        if rng.random() < 0.5:
            noise = noise + _engine_orders(n, rate, rng)
    elif kind < 0.85:
        noise = _hump(n, rate, rng) + rng.uniform(0.2, 1.0) * coloured_noise(n, 1.5, rng)
    else:
        gust = coloured_noise(n, 3.0, rng)
        noise = coloured_noise(n, rng.uniform(1.5, 2.5), rng) * np.exp(
            0.5 * rng.uniform(0.0, 1.0) * gust
        )
    return np.asarray(noise / noise.std())


def _engine_orders(n: int, rate: float, rng: Rng) -> Array:
    time = np.arange(n) / rate
    firing = rng.uniform(25.0, 120.0)
    orders = np.zeros(n)
    for k in (0.5, 1.0, 1.5, 2.0, 3.0):
        strength = rng.uniform(0.0, 0.5) / k
        orders += strength * np.sin(2.0 * np.pi * (k * firing * time + rng.random()))
    return orders


def _hump(n: int, rate: float, rng: Rng) -> Array:
    """Return noise in a band of one or two octaves."""
    m = next_fast_len(n, real=True)
    spectrum = rfft(rng.standard_normal(m))
    frequency = np.maximum(np.arange(spectrum.size) * rate / m, 1.0)
    centre = log_uniform(150.0, 1000.0, rng)
    octaves = np.log2(frequency / centre) / rng.uniform(0.5, 1.5)
    noise = irfft(spectrum * np.exp(-0.5 * octaves**2), m)[:n]
    return np.asarray(noise / noise.std())


def quiet(n: int, rate: float, rng: Rng) -> Array:
    """Return a random recording of quiet: a place, hiss, hum, background, sliding, silence.

    More than half are cabins and halls without people. Hum is of the mains or a transformer, 50 to
    120 Hz, with up to 20 harmonics, of which odd ones may be stronger. Steady sliding hisses
    without lines.

    Parameters
    ----------
    n : int
        Number of samples.
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> quiet(480, 48e3, np.random.default_rng(0)).shape
    (480,)
    """
    kind = picked(
        {"hiss": 0.12, "hum": 0.14, "background": 0.09, "sliding": 0.07, "place": 0.56,
         "silence": 0.02}, rng,
    )  # fmt: skip
    if kind == "silence":
        return np.zeros(n)
    if kind == "place":
        return place(n, rate, rng, peopled=False)
    if kind == "background":
        return background(n, rate, rng)
    noise = coloured_noise(n, rng.uniform(0.0, 2.2), rng)
    if kind == "hum":
        return noise + _hum(n, rate, rng)
    if kind == "sliding":
        octaves = coloured_noise(n, rng.uniform(0.0, 1.5), rng)
        return np.asarray(noise + rng.uniform(0.0, 2.0) * np.diff(octaves, prepend=octaves[0]))
    return noise


def _hum(n: int, rate: float, rng: Rng) -> Array:
    time = np.arange(n) / rate
    mains = float(rng.choice((50.0, 60.0, 100.0, 120.0))) * rng.uniform(0.999, 1.001)
    loud = 10.0 ** rng.uniform(-0.3, 1.7)
    roll_off = rng.uniform(0.3, 2.5)
    odd = rng.random() < 0.5
    hum = np.zeros(n)
    for k in range(1, int(rng.integers(2, 21))):
        strength = loud * k**-roll_off * rng.lognormal(0.0, 0.5)
        if odd and k % 2 == 0:
            strength *= 0.1
        hum += strength * np.sin(2 * math.pi * (k * mains * time + rng.random()))
    return hum
