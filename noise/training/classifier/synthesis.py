"""Synthesiser of the rows of ``background_sounds.toml``: layers of tones, noise, voices and blows.

Calls of a throat differ from a squeal by a pitch that glides by octaves, by constant formants and
by an envelope, and rough ones differ from a squawk or creak by irregular periods and modulated
noise. Blows are single, periodic or random. Tones of a machine have a common modulation. A bubble
has a frequency by its radius and rises as it nears the surface (Minnaert 1933).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from scipy.signal import lfilter

from noise.base.arrays import Array, Rng
from noise.training.draws import coloured_noise, log_uniform, wandering


def harmonics(pitch: Array, rate: float, roll_off: float, n_most: int = 30) -> Array:
    """Return the sum of harmonics of a pitch with amplitudes ``k ** -roll_off``.

    Parameters
    ----------
    pitch : ndarray, shape (n,)
        [Hz]
    rate : float
        [Hz]
    roll_off : float
        [-]
    n_most : int
        Maximum number of harmonics.

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> tone = harmonics(np.full(48_000, 440.0), 48e3, 1.0)
    >>> int(np.abs(np.fft.rfft(tone)).argmax())
    440
    """
    phase = 2.0 * np.pi * np.cumsum(pitch) / rate
    n = min(n_most, int(0.48 * rate / float(pitch.max())))
    before, now, twice = np.zeros(pitch.size), np.sin(phase), 2.0 * np.cos(phase)
    sound = np.zeros(pitch.size)
    for k in range(1, max(n, 1) + 1):
        sound += float(k) ** -roll_off * now
        before, now = now, twice * now - before
    return sound


def resonance(x: Array, centre: float, bandwidth: float, rate: float) -> Array:
    """Return a signal filtered by a resonance.

    Parameters
    ----------
    x : ndarray, shape (n,)
        [any unit]
    centre, bandwidth, rate : float
        [Hz]

    Returns
    -------
    ndarray, shape (n,)
        [unit of `x`]

    Examples
    --------
    >>> resonance(np.ones(4), 1e3, 100.0, 48e3).shape
    (4,)
    """
    radius = math.exp(-math.pi * bandwidth / rate)
    turn = 2.0 * radius * math.cos(2.0 * math.pi * min(centre, 0.45 * rate) / rate)
    return np.asarray(lfilter([1.0 - radius], [1.0, -turn, radius**2], x))


def through_formants(source: Array, formants: tuple[float, ...], rate: float, rng: Rng) -> Array:
    """Return a source with parallel resonances of a throat added.

    Parameters
    ----------
    source : ndarray, shape (n,)
        [any unit]
    formants : tuple of float
        [Hz]
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [unit of `source`]

    Examples
    --------
    >>> through_formants(np.ones(8), (500.0, 1500.0), 48e3, np.random.default_rng(0)).shape
    (8,)
    """
    sound = rng.uniform(0.02, 0.3) * source
    for k, formant in enumerate(formants):
        part = resonance(source, formant * rng.uniform(0.85, 1.15), rng.uniform(60, 350), rate)
        sound = sound + part * rng.uniform(0.5, 3.0) / (1.0 + 0.5 * k)
    return np.asarray(sound)


def envelope(
    sound: Array, shape: Mapping[str, Any], rate: float, draw: Callable[[Any], float]
) -> Array:
    """Return an event with an envelope.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        [any unit]
    shape : mapping
        ``arch``, a call that rises within that share, holds and fades; ``hann`` to a power;
        ``decay_s``, ``soft_s`` edges [s]; ``rise``, ``after`` and ``fall`` in shares.
    rate : float
        [Hz]
    draw : callable
        Function that draws a number from a range.

    Returns
    -------
    ndarray, shape (n,)
        [unit of `sound`]

    Examples
    --------
    >>> envelope(np.ones(5), {"hann": 1.0}, 48e3, float).tolist()
    [0.0, 0.5, 1.0, 0.5, 0.0]
    """
    n = sound.size
    x, time = np.linspace(0.0, 1.0, n), np.arange(n) / rate
    after = draw(shape.get("after", 0.0))
    if "arch" in shape:
        rise, fall = draw([0.3, 1.5]) * draw(shape["arch"]), draw([0.1, 0.7])
        sound = sound * np.minimum(1.0, np.minimum(x / rise, (1.0 - x) / fall)) ** draw([0.5, 2.0])
    if "hann" in shape:
        sound = sound * np.hanning(n) ** draw(shape["hann"])
    if "decay_s" in shape:
        sound = sound * np.exp(-time / draw(shape["decay_s"]))
    if "fall" in shape:
        fallen = np.exp(-np.maximum(x - after, 0.0) / draw(shape["fall"]))
        sound = sound * fallen * (x >= after)
    if "rise" in shape:
        end = draw(shape["rise"])
        sound = sound * x / end * (x <= end)
    if "soft_s" in shape:
        sound = sound * np.minimum(1.0, np.minimum(time, time[::-1]) / draw(shape["soft_s"]))
    return sound


def voiced(
    n: int,
    rate: float,
    pitch: Array,
    formants: tuple[float, ...],
    rng: Rng,
    *,
    roughness: float = 0.0,
    breath: float = 0.1,
) -> Array:
    """Return a random call: pitch with jitter, subharmonics if rough, formants and breath.

    Parameters
    ----------
    n : int
    rate : float
        [Hz]
    pitch : ndarray, shape (n,)
        [Hz]
    formants : tuple of float
        [Hz]
    rng : numpy.random.Generator
    roughness : float
        0 is a clear voice; 1 doubles and breaks its periods [-].
    breath : float
        Noise over the voice [-].

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> float(np.abs(voiced(480, 48e3, np.full(480, 300.0), (900.0,), rng)).max())
    1.0
    """
    jitter = coloured_noise(n, 1.5, rng)
    pitch = pitch * np.exp((0.004 + 0.08 * roughness) * jitter)
    source = harmonics(pitch, rate, rng.uniform(0.3, 1.6), n_most=40)
    if roughness > 0.0:
        half = 2.0 * np.pi * np.cumsum(pitch) / rate / float(rng.choice((2.0, 2.0, 3.0)))
        source *= 1.0 + roughness * np.cos(half)
        source *= np.exp(roughness * 0.6 * coloured_noise(n, 0.8, rng))
    source = source / (source.std() + 1e-12) + breath * coloured_noise(n, 0.3, rng)
    sound = through_formants(source, formants, rate, rng)
    return np.asarray(sound / (np.abs(sound).max() + 1e-300))


def placed(n: int, times: Array, strength: Array, rate: float) -> Array:
    """Return impulses at given times.

    Parameters
    ----------
    n : int
        Number of samples.
    times : ndarray, shape (m,)
        [s]
    strength : ndarray, shape (m,)
        [any unit]
    rate : float
        [Hz]

    Returns
    -------
    ndarray, shape (n,)
        [unit of `strength`]

    Examples
    --------
    >>> placed(4, np.array([0.5]), np.array([2.0]), 4.0).tolist()
    [0.0, 0.0, 2.0, 0.0]
    """
    hits = np.zeros(n)
    index = (np.asarray(times) * rate).astype(int)
    inside = (index >= 0) & (index < n)
    np.add.at(hits, index[inside], strength[inside])
    return hits


def blow(
    rate: float,
    band: tuple[float, float],
    decay: tuple[float, float],
    rng: Rng,
    *,
    n_modes: int = 8,
    noise: float = 0.5,
    ratios: Sequence[float] = (),
) -> Array:
    """Return the sound of a blow: decaying modes in a band, and a noisy knock.

    Parameters
    ----------
    rate : float
        [Hz]
    band : pair of float
        [Hz]
    decay : pair of float
        [s]
    rng : numpy.random.Generator
    n_modes : int
    noise : float
        Maximum level of the knock relative to the modes [-].
    ratios : sequence of float
        Of a bell: frequencies of its modes, over one in the band; the higher ones die sooner.

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> blow(48e3, (500.0, 3000.0), (0.005, 0.02), np.random.default_rng(0)).ndim
    1
    """
    longest = min(7.0 * decay[1], 3.0)
    time = np.arange(max(16, int(longest * rate))) / rate
    sound = np.zeros(time.size)
    for ratio in ratios or [1.0] * n_modes:
        frequency = min(ratio * log_uniform(*band, rng), 0.45 * rate)
        lasting = log_uniform(*decay, rng) / (0.5 + 0.5 * ratio)
        sound += rng.normal() * np.exp(-time / lasting) * np.sin(2 * np.pi * frequency * time)
    sound /= np.abs(sound).max() + 1e-12
    knock = rng.standard_normal(time.size) * np.exp(-time / rng.uniform(0.0005, 0.01))
    return np.asarray(sound + noise * rng.random() * knock)


def wavering(n: int, rate: float, frequency: float, depth: float, rng: Rng) -> Array:
    """Return a random factor near 1 that varies by `depth` with a given frequency.

    Examples
    --------
    >>> float(wavering(10, 10.0, 1.0, 0.0, np.random.default_rng(0)).max())
    1.0
    """
    return np.asarray(np.exp(depth * wandering(n, rate, frequency, rng)))


Row = Mapping[str, Any]


class Draws(dict[str, float]):
    """Random numbers from ranges, with names for references."""

    def __init__(self, rng: Rng, names: Mapping[str, float] | None = None) -> None:
        super().__init__(names or {})
        self.rng = rng

    def __call__(self, spec: Any) -> float:
        """Return a random number from a range.

        Examples
        --------
        >>> draws = Draws(np.random.default_rng(0)).with_names({"low": 3.0})
        >>> draws({"one": [2.0], "times": "low"}), draws("low"), 0.0 <= draws([0, 1]) <= 1.0
        (6.0, 3.0, True)
        """
        if isinstance(spec, str):
            return self[spec]
        if isinstance(spec, list):
            return float(self.rng.uniform(self(spec[0]), self(spec[1])))
        if not isinstance(spec, dict):
            return float(spec)
        if "log" in spec:
            number = log_uniform(spec["log"][0], spec["log"][1], self.rng)
        elif "db" in spec:
            number = 10.0 ** (self.rng.uniform(*spec["db"]) / 20.0)
        elif "one" in spec:
            number = float(self.rng.choice(spec["one"]))
        else:
            number = float(self.rng.uniform(*spec["uniform"]))
        return number * self.get(spec.get("times", ""), 1.0) / self.get(spec.get("over", ""), 1.0)

    def with_names(self, specs: Row | None) -> Draws:
        """Return a copy with further named numbers."""
        more = Draws(self.rng, self)
        for name, spec in (specs or {}).items():
            more[name] = more(spec)
        return more

    def whole(self, spec: Any) -> int:
        """Return a random integer; both ends are included."""
        if isinstance(spec, list):
            return int(self.rng.integers(spec[0], spec[1] + 1))
        return int(self(spec))


def synthesised(row: Row, n: int, rate: float, rng: Rng) -> Array:
    """Return a random sound of a row.

    Parameters
    ----------
    row : mapping
        Row of ``background_sounds.toml``.
    n : int
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> row = {"layer": [{"source": "harmonics", "pitch": 440.0, "n": 1}]}
    >>> tone = synthesised(row, 48_000, 48e3, np.random.default_rng(0))
    >>> int(np.abs(np.fft.rfft(tone)).argmax())
    440
    """
    draws = Draws(rng).with_names(row.get("shared"))
    kinds = row.get("kinds", {"": 1.0})
    kind = str(rng.choice(list(kinds), p=np.array(list(kinds.values())) / sum(kinds.values())))
    sound = np.zeros(n)
    for layer in row["layer"]:
        if layer.get("kind", kind) != kind or rng.random() >= layer.get("chance", 1.0):
            continue
        for i in range(draws.whole(layer.get("copies", 1))):
            own = draws.with_names(layer.get("let"))
            part = _changed(_in_time(layer, n, rate, own), layer, rate, own)
            level = own(layer.get("further", 1.0) if i else 1.0)
            sound += level * own(layer.get("level", 1.0)) * part / (part.std() + 1e-12)
    if rng.random() < row.get("through", {}).get("chance", 0.0):
        sound = _through(sound, {"through": row["through"]["resonances"]}, rate, draws)
    return _changed(sound, row, rate, draws) + 1e-5 * rng.standard_normal(n)


def _in_time(layer: Row, n: int, rate: float, draws: Draws) -> Array:
    """Return the events of a layer in time."""

    def event(m: int, turn: int) -> Array:
        each = draws.with_names(layer.get("each"))
        parts = layer.get("parts", [layer])
        if "either" in layer:
            parts = [parts[int(draws.rng.choice(len(parts), p=layer["either"]))]]
        made = [_made(part, m, rate, each, turn) for part in parts]
        sound = np.zeros(max(part.size for part in made))
        for part, sounding in zip(parts, made, strict=True):
            level = each(part.get("level", 1.0)) if len(made) > 1 or "either" in layer else 1.0
            sound[: sounding.size] += level * sounding / (np.abs(sounding).max() + 1e-12)
        return envelope(sound, layer.get("shape", {}), rate, each) if "parts" in layer else sound

    if "repeat" in layer:
        return repeated(n, rate, layer["repeat"], event, draws)
    if "at" not in layer:
        return event(n, 0)
    sound, when = np.zeros(n), layer["at"]
    times = event_times(when, n / rate, draws)
    length = when.get("length_s", 0.1)
    alike = [event(int(draws(length) * rate), k) for k in range(when.get("same", 0))]
    strength = _strengths(when, times.size, draws)
    for k, (time, factor) in enumerate(zip(times, strength, strict=True)):
        at = int(time * rate)
        if at < n:
            part = alike[k % len(alike)] if alike else event(int(draws(length) * rate), k)
            part = part[max(0, -at) : n - at]  # ringing of earlier blows
            sound[max(0, at) : max(0, at) + part.size] += factor * part
    return sound


def repeated(
    n: int, rate: float, when: Row, make: Callable[[int, int], Array], draws: Draws
) -> Array:
    """Return random consecutive events; the first may have begun before.

    Parameters
    ----------
    n : int
        Number of samples.
    rate : float
        [Hz]
    when : mapping
        ``lengths`` and ``gaps`` [s]; further keys as in the table.
    make : callable
        Function from the number of samples m and the index of an event to an ndarray of shape
        (m,).
    draws : Draws

    Examples
    --------
    >>> draws = Draws(np.random.default_rng(0))
    >>> when = {"lengths": [0.01, 0.02], "gaps": [0.01, 0.02]}
    >>> sound = repeated(4800, 48e3, when, lambda m, _: np.ones(m), draws)
    >>> bool(sound.min() == 0.0 < sound.max())
    True
    """
    sound, rng = np.zeros(n), draws.rng
    unit = draws(when.get("unit", 1.0))
    gaps, lengths = ([unit * draws(end) for end in when[key]] for key in ("gaps", "lengths"))
    groups = draws.whole(when["on"]) if "on" in when and rng.random() < 0.5 else 0
    start, turn = int(rng.uniform(0.0, min(gaps[1], 0.3)) * rate), 0
    while start < n:
        length = rng.choice(lengths) if when.get("whole") else log_uniform(*_ends(lengths), rng)
        m = max(64, int(length * rate))
        if not groups or turn % (groups + 2) < groups:
            part = make(m, turn)[: n - start]
            factor = 1.0 if when.get("even") else 10.0 ** (rng.uniform(-6.0, 0.0) / 20.0)
            sound[start : start + part.size] += factor * part
        start += m + int(log_uniform(*_ends(gaps), rng) * rate)
        turn += 1
    return sound


def _ends(pair: list[float]) -> tuple[float, float]:
    return min(pair), max(pair)


def event_times(when: Row, duration: float, draws: Draws) -> Array:
    """Return random times [s]: periodic, random, with gamma-distributed gaps, or after a start.

    Examples
    --------
    >>> event_times({"beat": 4.0}, 1.0, Draws(np.random.default_rng(0))).round(2).tolist()
    [-0.09, 0.16, 0.41, 0.66, 0.91, 1.16]
    """
    rng = draws.rng
    if "beat" in when:
        pace, jitter = draws(when["beat"]), draws(when.get("jitter", 0.0))
        beats = np.arange(-1, int(duration * pace) + 1)
        times = (beats + rng.random() + jitter * rng.standard_normal(beats.size)) / pace
        times = times[beats % 8 < draws.whole(when.get("on", 8))]
    elif "gamma" in when:
        pace, shape = draws(when["gamma"]), draws(when["irregular"]) ** -2.0
        times = np.cumsum(rng.gamma(shape, 1.0 / (shape * pace), int(2 * pace * duration) + 4))
    elif "random" in when:
        count = rng.poisson(min(draws(when["random"]) * duration, 1e5)) + 1
        times = rng.uniform(0.0, duration, count)
    else:
        start, spread = draws(when["start"]) * duration, draws(when["spread"])
        times = start + np.r_[0.0, rng.exponential(spread, draws.whole(when["count"]) - 1)]
    if "echo" in when:
        times = np.r_[times, times + draws(when["echo"]) * rng.uniform(0.9, 1.1, times.size)]
    return times


def _strengths(when: Row, count: int, draws: Draws) -> Array:
    if "pareto" in when:
        size = np.minimum(draws.rng.pareto(draws(when["pareto"]), count) + 0.05, 60.0)
        return np.asarray(size * draws.rng.choice((-1.0, 1.0), count))
    return draws.rng.lognormal(0.0, draws(when.get("scatter", 0.0)), count)


def _made(part: Row, m: int, rate: float, draws: Draws, turn: int) -> Array:
    """Return an event of `m` samples; a blow has its own length."""
    rng, source = draws.rng, part["source"]
    if source == "blow":
        ratios = part.get("ratios", ())
        band, decay = (tuple(map(draws, part[key])) for key in ("band", "decay"))
        return blow(rate, (band[0], band[1]), (decay[0], decay[1]), rng, ratios=ratios,
                    n_modes=part.get("modes", 8), noise=draws(part.get("knock", 0.5)))  # fmt: skip
    if source == "bubble":
        sound = _bubble(m, rate, rng)
    elif source == "noise":
        sound = coloured_noise(m, draws(part["slope"]), rng)
    elif source == "hits":
        times = event_times(part["hits"], m / rate, draws)
        sound = placed(m, times, _strengths(part["hits"], times.size, draws), rate)
    else:
        sound = _toned(part, m, rate, draws, turn)
    if source != "voice" and "formants" in part:
        sound = through_formants(sound, tuple(map(draws, part["formants"])), rate, rng)
    for change in part.get("before", ()):
        sound = sound * _course(change, m, rate, draws)
    return envelope(_through(sound, part, rate, draws), part.get("shape", {}), rate, draws)


def _toned(part: Row, m: int, rate: float, draws: Draws, turn: int) -> Array:
    pitch = pitch_course(part["pitch"], m, rate, draws, turn)
    if part["source"] == "voice":
        formants = tuple(draws(part.get("size", 1.0)) * draws(f) for f in part["formants"])
        roughness, breath = draws(part["roughness"]), draws(part["breath"])
        return voiced(m, rate, pitch, formants, draws.rng, roughness=roughness, breath=breath)
    if part["source"] == "firing":
        return _firing(pitch, rate, draws.rng)
    sound, roll_off = np.zeros(m), draws(part.get("roll_off", 1.0))
    for ratio in part.get("chord", [1.0]):
        note = np.minimum(draws(ratio) * pitch, 0.45 * rate)
        sound += harmonics(note, rate, roll_off, n_most=draws.whole(part.get("n", 30)))
    return sound


def _firing(pitch: Array, rate: float, rng: Rng) -> Array:
    """Return unequal firing pulses through an exhaust, with modulated noise."""
    phase = 2 * np.pi * np.cumsum(pitch) / rate
    phase += 0.5 * rng.random() ** 3 * coloured_noise(pitch.size, 1.8, rng)
    unequal = 1.0 + rng.uniform(0.0, 0.6) * np.sin(phase / float(rng.choice((2.0, 3.0, 4.0))))
    beat = np.exp(rng.uniform(0.5, 8.0) * (np.cos(phase) - 1.0)) * unequal
    source = np.gradient(beat)
    noise = coloured_noise(pitch.size, rng.uniform(0.2, 1.5), rng)
    sound = source / (source.std() + 1e-12) + rng.uniform(0.0, 1.5) * beat * noise
    for _ in range(3):
        centre, width = log_uniform(80.0, 2500.0, rng), rng.uniform(60.0, 500.0)
        sound = sound + rng.uniform(0.0, 2.0) * resonance(sound, centre, width, rate)
    return np.asarray(sound + rng.uniform(0.02, 0.7) * sound.std() * noise)


def _bubble(m: int, rate: float, rng: Rng) -> Array:
    """Return a decaying chirp that rises by up to an octave."""
    time = np.arange(max(m, 16)) / rate
    start = log_uniform(400.0, 5000.0, rng)
    rise = rng.uniform(0.0, 1.0) * time / time[-1]
    phase = 2 * np.pi * np.cumsum(np.minimum(start * np.exp2(rise), 0.45 * rate)) / rate
    sound = np.sin(phase) * np.exp(-5.0 * time / time[-1])
    sound[: max(2, int(0.0005 * rate))] += rng.normal(0.0, 0.5)
    return np.asarray(sound)


def pitch_course(spec: Any, m: int, rate: float, draws: Draws, turn: int = 0) -> Array:
    """Return the random pitch [Hz] of an event of `m` samples.

    Examples
    --------
    >>> pitch_course(440.0, 3, 48e3, Draws(np.random.default_rng(0))).tolist()
    [440.0, 440.0, 440.0]
    """
    if not isinstance(spec, dict) or not {"at", "semitones"} & set(spec):
        return np.full(m, min(draws(spec), 0.45 * rate))
    rng, x, time = draws.rng, np.linspace(0.0, 1.0, m), np.arange(m) / rate
    octaves = np.zeros(m)
    if spec.get("glide"):
        size = 1.0 if rng.random() < 0.6 else 0.2  # some calls have a nearly constant pitch
        peak = rng.uniform(0.1, 0.6)
        rising = np.sin(0.5 * np.pi * x / peak)
        arch = np.where(x < peak, rising, np.cos(0.5 * np.pi * (x - peak) / (1.0 - peak)))
        octaves += size * (rng.uniform(-0.15, 1.0) * arch + rng.uniform(-0.5, 0.3) * (x - 0.5))
    octaves += draws(spec.get("bend", 0.0)) * x + draws(spec.get("hump", 0.0)) * np.sin(np.pi * x)
    if "tremble" in spec:
        depth, pace = map(draws, spec["tremble"])
        octaves += depth * np.sin(2 * np.pi * (pace * time + rng.random()))
    if "cycle" in spec:
        turned = draws(spec["cycle"][2]) * (time + 3.0 * rng.random()) % 1.0
        form = {"saw": turned, "square": (turned > 0.5).astype(float),
                "sine": 0.5 + 0.5 * np.sin(2 * np.pi * turned)}[spec["cycle"][0]]  # fmt: skip
        octaves += draws(spec["cycle"][1]) * form
    pitch = np.exp2(octaves)
    if "wander" in spec:
        depth, pace = map(draws, spec["wander"])
        pitch = pitch * wavering(m, rate, pace, depth, rng)
    if "semitones" in spec:
        note = int(draws(spec["low"])) + int(rng.integers(spec["semitones"]))
        pitch = pitch * 55.0 * 2.0 ** (note / 12.0)
    else:
        pitch = pitch * draws(spec["at"])
    if "turn" in spec and turn % 2:
        pitch = pitch * draws(spec["turn"])
    return np.asarray(np.clip(pitch, 5.0, 0.45 * rate))


def _through(sound: Array, part: Row, rate: float, draws: Draws) -> Array:
    """Return a sound with resonances added to its direct part."""
    if "through" not in part:
        return sound
    level = sound.std() + 1e-12
    resounding = draws(part.get("direct", 1.0)) * sound
    for centre, width, gain in part["through"]:
        rung = resonance(sound, draws(centre), draws(width), rate)
        resounding = resounding + max(draws(gain), 0.0) * level * rung / (rung.std() + 1e-12)
    return np.asarray(resounding)


def _changed(sound: Array, row: Row, rate: float, draws: Draws) -> Array:
    for change in row.get("changes", ()):
        sound = sound * _course(change, sound.size, rate, draws)
    return sound


def _course(change: Row, n: int, rate: float, draws: Draws) -> Array:
    """Return a random factor over time."""
    ((kind, specs),) = change.items()
    rng, time = draws.rng, np.arange(n) / rate
    if kind == "strokes":  # to and fro with different strengths
        pace = draws(specs)
        x = time * pace + rng.random() + 0.15 * wandering(n, rate, pace, rng)
        stroke = np.abs(np.sin(np.pi * x)) ** rng.uniform(0.4, 2.0)
        return np.asarray(0.03 + stroke * np.where(x.astype(int) % 2, rng.uniform(0.1, 1.0), 1.0))
    if kind == "signed":
        return wandering(n, rate, draws(specs), rng)
    if kind == "bubbling":
        popping = np.maximum(rng.standard_normal(n), 0.0)
        gate = np.abs(resonance(popping - popping.mean(), draws(specs), 40.0, rate))
        return np.asarray(0.1 + gate / (gate.max() + 1e-12))
    numbers = map(draws, specs)
    first, second = next(numbers), next(numbers)
    if kind == "wander":
        return wavering(n, rate, second, first, rng)
    if kind == "noise":
        return np.asarray(np.exp(first * coloured_noise(n, second, rng)))
    if kind == "sine":
        return np.asarray(1.0 + first * np.sin(2 * np.pi * (second * time + rng.random())))
    if kind == "beat":
        phase = 2 * np.pi * np.cumsum(second * wavering(n, rate, 0.5, 0.03, rng)) / rate
        return np.asarray(np.exp(first * (np.cos(phase) - 1.0)))
    if kind == "after":
        since = time - first * n / rate
        return np.asarray(np.where(since > 0.0, np.exp(-np.maximum(since, 0.0) / second), 0.0))
    if kind == "teeth":
        speed = np.abs(np.sin(np.pi * next(numbers) * time))
        strike = np.exp(first * (np.cos(2 * np.pi * np.cumsum(speed) / rate * second) - 1.0))
        return np.asarray(rng.uniform(0.1, 1.0) + strike)
    on, period = round(next(numbers)), round(next(numbers))  # pulsed
    pulse = (time + rng.random()) * first
    place = pulse % 1.0
    inside = np.where(place < second, np.sin(np.pi * place / second), 0.0) ** rng.uniform(0.5, 1.5)
    return np.asarray(inside * (pulse.astype(int) % max(period, on) < on))
