"""Synthesis of creaks, squawks and squeals of the bodies in ``friction_sounds.toml``.

- slips: each slip of `noise.training.classifier.friction_mechanisms` releases a force in
  proportion to its size, a half-sine pulse with the rattle of asperities, and the body
  (`noise.training.classifier.friction_mechanisms`) rings. A heavier load gives fewer and
  larger slips.
- sawtooth: steady stick-slip whose force, with close harmonics, is radiated by a strongly damped
  body; likewise a bowed string.
- modes: friction excites modes (`noise.training.classifier.friction_mechanisms`). If they
  share their losses, one dominates and another may replace it; otherwise several sound at once.

By definition (`noise.noise_definition`), slips so regular and fast that discrete frequencies stand
out are a squawk, others a creak; cases in between are ambiguous.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.signal import fftconvolve

from noise.base import packaged_toml
from noise.base.arrays import Array, Rng
from noise.training.classifier.friction_mechanisms import (
    ENVELOPE_RATE,
    ModalBody,
    Slips,
    amplitudes,
    carried,
    overlapping_modes,
    random_body,
    random_drive,
    slide,
)
from noise.training.draws import Span, coloured_noise, log_uniform, low_pass, wandering

FRICTION_SOUNDS: Mapping[str, Mapping[str, Any]] = packaged_toml(
    "noise.training.classifier", "friction_sounds.toml"
)
"""Rows of the table by name."""

_CONTACT = 0.05
"""Minimum load of a contact [-]."""

_PITCHED = 150.0
"""Slip rate from which a pitch is audible [Hz]."""

_REGULAR = 0.06
"""Median logarithmic change between sticks below which harmonics stand out [-]."""


def friction_sound(name: str, n: int, rate: float, rng: Rng) -> tuple[Array, Span, bool]:
    """Return a random sound of a body.

    Parameters
    ----------
    name : str
        One of `FRICTION_SOUNDS`.
    n : int
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Returns
    -------
    samples : ndarray, shape (n,)
        Samples of unit peak [-].
    span : tuple of float
        Start and end of the friction [s].
    ambiguous : bool
        Whether the label is close to a bound of its definition.

    Examples
    --------
    >>> sound, span, ambiguous = friction_sound("belt_squeal", 24_000, 48e3,
    ...                                         np.random.default_rng(0))
    >>> sound.shape, round(float(np.abs(sound).max()), 6)
    ((24000,), 1.0)
    """
    row = FRICTION_SOUNDS[name]
    m = int(n / rate * ENVELOPE_RATE) + 2
    load = contact_load(row, m, rng)
    ambiguous = False
    if row["mechanism"] == "slips":
        slips, load = _slips_under(load, row, n, rate, rng)
        sound = _struck(slips, load, row, n, rate, rng)
        ambiguous = _is_ambiguous(slips, row["label"])
        span = (float(slips.time[0]), float(slips.time[-1]) + 0.02)
    else:
        make = _sawtooth if row["mechanism"] == "sawtooth" else _modes
        sound = make(load, row, n, rate, rng)
        rubbing = np.flatnonzero(load > _CONTACT) / ENVELOPE_RATE
        span = (float(rubbing[0]), float(rubbing[-1]))
    return sound / np.abs(sound).max(), (span[0], min(span[1], n / rate)), ambiguous


def contact_load(row: Mapping[str, Any], m: int, rng: Rng) -> Array:
    """Return a random load of a contact at `ENVELOPE_RATE`: bouts near 1 with gaps of 0.

    Parameters
    ----------
    row : mapping
        Row of `FRICTION_SOUNDS`; without ``bout_s`` the contact is permanent.
    m : int
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (m,)
        [-]

    Examples
    --------
    >>> row = {"bout_s": [0.1, 0.2], "gap": [1.0, 1.0], "arch": [4.0, 4.0]}
    >>> load = contact_load(row, 6000, np.random.default_rng(0))
    >>> bool(0.2 < np.mean(load > 0.0) < 0.8)
    True
    """
    chirping = rng.random() < row.get("chirps", 0.0)
    alone = chirping and rng.random() < 0.5
    bouts, gaps = row.get("bout_s"), row.get("gap", [0.0, 0.5])
    if chirping:
        bouts, gaps = [0.1, 0.5], [0.1, 3.0]
    load = np.zeros(m) if bouts else np.full(m, rng.uniform(0.8, 1.2))
    start = 0 if rng.random() < 0.5 else int(rng.uniform(0.0, 0.6 if alone else 0.15) * m)
    while start < m and bouts:
        bout = _log_between(bouts, rng) if chirping else rng.uniform(*bouts)
        end = min(m, start + int(bout * ENVELOPE_RATE) + 1)
        x = np.linspace(0.0, 1.0, end - start)
        steep = rng.uniform(*row.get("arch", (4.0, 40.0)))
        arch = np.minimum(1.0, np.minimum(x, 1.0 - x) * steep) ** 0.5
        load[start:end] = arch * rng.uniform(0.6, 1.2)
        start = m if alone else end + int(bout * rng.uniform(*gaps) * ENVELOPE_RATE)
    if "modulation" in row:
        pace = _log_between(row["modulation_hz"], rng)
        fast = 1.0 + rng.uniform(*row["modulation"]) * wandering(m, ENVELOPE_RATE, pace, rng)
        load = load * np.maximum(fast, 0.0)
    load = load * (1.0 + 0.3 * wandering(m, ENVELOPE_RATE, 1.0, rng))
    return load if np.any(load > _CONTACT) else contact_load(row, m, rng)


def _slips_under(
    load: Array, row: Mapping[str, Any], n: int, rate: float, rng: Rng
) -> tuple[Slips, Array]:
    """Return random slips at a suitable rate, and the load."""
    while True:
        fastest = _log_between(row["fastest_hz"], rng)
        slowest = max(4.0, fastest * math.exp(-rng.uniform(*row.get("glide", (0.7, 4.0)))))
        if slowest < 0.95 * fastest:
            drive = random_drive(n, rate, slowest, fastest, rng, steps=row.get("steps", False))
            if "bout_s" in row:
                pressed = np.interp(np.arange(n) / rate * ENVELOPE_RATE, range(load.size), load)
                drive = np.where(pressed > _CONTACT, drive / np.clip(pressed, 0.3, 2.0), 0.0)
            slips = slide(
                drive,
                rate,
                ageing_time=_log_between(row.get("ageing_s", (3e-4, 3e-2)), rng),
                scatter=_log_between(row.get("scatter", (0.02, 0.35)), rng),
                rng=rng,
            )
            per_second = slips.time.size * rate / n
            if slips.time.size >= 5 and (4.0 if "bout_s" in row else 8.0) <= per_second < 900.0:
                return slips, load
        load = contact_load(row, load.size, rng)


def _is_ambiguous(slips: Slips, label: str) -> bool:
    """Whether the regularity of slips is close to that of the other label."""
    sticks = np.diff(slips.time)
    changes = np.median(np.abs(np.diff(np.log(sticks[sticks < 0.1]))))
    if label == "creak":
        return bool(np.median(sticks) < 1.0 / _PITCHED and changes < _REGULAR)
    return bool(np.median(sticks) > 1.0 / (0.7 * _PITCHED) or changes > 1.5 * _REGULAR)


def _struck(
    slips: Slips, load: Array, row: Mapping[str, Any], n: int, rate: float, rng: Rng
) -> Array:
    """Return the sound of slips that strike a body, with a second contact in a fifth of cases."""
    sound = np.zeros(n)
    for i in range(2 if rng.random() < 0.2 else 1):
        if i:
            slips, load = _slips_under(load, row, n, rate, rng)
        below = np.interp(slips.time * ENVELOPE_RATE, range(load.size), np.minimum(load, 1.0)) - 1.0
        swell = 10.0 ** (rng.uniform(*row.get("swell_db", (0.0, 0.0))) / 20.0 * below)
        swollen = Slips(slips.time, slips.size * swell)
        force = pulses(swollen, n, rate, rng, lasting=row.get("pulse_s", (3e-5, 5e-4)))
        parts = [_unit(random_body(row["body_hz"], row["damping"], rng).impulse_response(rate))]
        parts.append(10.0 ** (rng.uniform(-25.0, 20.0) / 20.0) * overlapping_modes(rate, rng))
        if rng.random() < 0.4:  # sound of a neighbouring body
            other = FRICTION_SOUNDS[str(rng.choice(_STRUCK))]
            fixed_to = random_body(other["body_hz"], other["damping"], rng)
            parts.append(rng.uniform(0.1, 1.0) * _unit(fixed_to.impulse_response(rate)))
        body = np.zeros(max(part.size for part in parts))
        for part in parts:
            body[: part.size] += part
        struck = fftconvolve(force, body)[:n]
        # Direct sound of the contact, a click.
        if "radiates_above_hz" in row:
            corner = _log_between(row["radiates_above_hz"], rng)
            for _ in range(2):
                struck = struck - low_pass(struck, corner, rate)
        click = np.diff(force, prepend=0.0)
        direct = 10.0 ** (rng.uniform(-30.0, 0.0) / 20.0) * float(np.abs(struck).max())
        struck = struck + direct * click / (np.abs(click).max() + 1e-300)
        peak = float(np.abs(struck).max())
        sound += rng.uniform(0.4, 1.0) * struck / peak if peak > 0.0 else 0.0
    level = float(np.abs(sound).max()) * 10.0 ** rng.uniform(-4.0, -1.6)
    return np.asarray(sound + level * coloured_noise(n, rng.uniform(0.3, 1.5), rng))


_STRUCK = [name for name, row in FRICTION_SOUNDS.items() if row["mechanism"] == "slips"]


def _log_between(ends: Sequence[float], rng: Rng) -> float:
    return log_uniform(ends[0], ends[1], rng)


def _logs_between(ends: Sequence[float], n: int, rng: Rng) -> Array:
    low, high = np.log(ends)
    return np.asarray(np.exp(rng.uniform(low, high, n)))


def _unit(response: Array) -> Array:
    return np.asarray(response / np.abs(response).max())


def pulses(
    slips: Slips, n: int, rate: float, rng: Rng, *, lasting: Sequence[float] = (3e-5, 5e-4)
) -> Array:
    """Return the force of slips: pulses of random strength, with a rattle.

    Parameters
    ----------
    slips : Slips
    n : int
        Number of samples.
    rate : float
        [Hz]
    rng : numpy.random.Generator
    lasting : pair of float
        Range of the duration of a pulse [s].

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> slips = Slips(np.array([0.01]), np.array([1.0]))
    >>> force = pulses(slips, 960, 48e3, np.random.default_rng(0))
    >>> bool(np.abs(force[:470]).max() < 1e-9), bool(force.max() > 0.0)
    (True, True)
    """
    strength = slips.size ** rng.uniform(0.6, 1.6) * np.exp(
        rng.normal(0.0, rng.uniform(0.02, 0.5), slips.size.size)
    )
    place = slips.time * rate
    first = np.clip(place.astype(int), 0, n - 2)
    part = np.clip(place - first, 0.0, 1.0)
    train = np.zeros(n)
    np.add.at(train, first, strength * (1.0 - part))
    np.add.at(train, first + 1, strength * part)
    m = max(2, int(_log_between(lasting, rng) * rate))
    shape = np.sin(np.pi * (np.arange(m) + 0.5) / m)
    rattle = rng.standard_normal(4 * m) * np.exp(-np.arange(4 * m) / m)
    shape = np.concatenate([shape, np.zeros(3 * m)]) + rng.uniform(0.0, 0.8) * rattle
    return np.asarray(fftconvolve(train, shape)[:n])


def _sawtooth(load: Array, row: Mapping[str, Any], n: int, rate: float, rng: Rng) -> Array:
    slips_a_second = _log_between(row["rate_hz"], rng)
    wander = rng.uniform(*row["wander"]) * wandering(n, rate, rng.uniform(0.5, 5.0), rng)
    shake = np.sin(2.0 * np.pi * rng.uniform(4.0, 8.0) * np.arange(n) / rate)
    drive = slips_a_second * (1.0 + wander + rng.uniform(*row["vibrato"]) * shake)
    slips = slide(
        drive,
        rate,
        ageing_time=rng.uniform(0.02, 0.1) / slips_a_second,
        scatter=rng.uniform(*row["scatter"]),
        rng=rng,
    )
    # The force of the spring rises with the drive and falls at each slip, within about 1 ms.
    force = np.cumsum(drive) / rate
    fallen = np.zeros(n)
    np.add.at(fallen, np.minimum((slips.time * rate).astype(int), n - 1), slips.size)
    fall = np.hanning(max(2, int(rng.uniform(*row["fall"]) / slips_a_second * rate)) + 2)[1:-1]
    force -= np.cumsum(fftconvolve(fallen, fall / fall.sum())[:n])
    direct = np.gradient(force) * np.interp(
        np.arange(n) / rate * ENVELOPE_RATE, range(load.size), load
    )
    n_modes = int(rng.integers(3, 9))
    # Broad resonances, which do not ring until the next slip.
    response = ModalBody(
        _logs_between(row["body_hz"], n_modes, rng),
        np.full(n_modes, rng.uniform(*row["damping"])),
        rng.standard_normal(n_modes),
    ).impulse_response(rate)
    through = fftconvolve(direct, response)[:n]
    sound = through / (through.std() + 1e-12)
    sound = sound + rng.uniform(*row["direct"]) * direct / (direct.std() + 1e-12)
    hiss = coloured_noise(n, rng.uniform(0.2, 1.5), rng)
    level = 10.0 ** (rng.uniform(*row.get("hiss_db", (-40.0, -10.0))) / 20.0)
    return np.asarray(sound + sound.std() * level * hiss)


def _modes(load: Array, row: Mapping[str, Any], n: int, rate: float, rng: Rng) -> Array:
    m = load.size
    chances = np.array(row.get("n_modes", (0.6, 0.3, 0.1)))
    n_modes = int(rng.choice(chances.size, p=chances / chances.sum())) + 1
    frequency = _logs_between(row["frequency_hz"], n_modes, rng)
    if "ratio" in row:
        frequency[1:] = frequency[0] * rng.uniform(row["ratio"][0], row["ratio"][1], n_modes - 1)
    competing = "cross" not in row
    size = rng.uniform(*row["growth"])
    drift = rng.uniform(*row["drift"])
    omega = 2.0 * np.pi * frequency
    turns = np.full(n_modes, omega[0]) if competing else omega
    pace = max(abs(size), 0.002) * turns
    # Without contact the modes are damped; each mode has a load of its own.
    growth = np.empty((n_modes, m))
    detuning = np.empty((n_modes, m))
    for i in range(n_modes):
        own = load if i == 0 else load * (1.0 + 0.4 * wandering(m, ENVELOPE_RATE, 1.5, rng))
        growth[i] = np.where(load > _CONTACT, size * turns[i] * own, -2.0 * pace[i] - 30.0)
        bend = load - 1.0 + 0.4 * wandering(m, ENVELOPE_RATE, rng.uniform(0.7, 6.0), rng)
        detuning[i] = omega[i] * drift * np.clip(bend, -1.2, 1.2)
    cross = rng.uniform(*row.get("cross", (1.2, 2.0)))
    coupling = pace[:, None] * (np.eye(n_modes) * (1.0 - cross) + cross)
    roughness = rng.uniform(*row["roughness"]) * np.sqrt(pace)
    rubbed = np.where(load > _CONTACT, np.sqrt(np.minimum(load, 1.0)), 0.0)
    solved = amplitudes(growth, detuning, coupling, roughness[:, None] * rubbed, rng)
    # Other modes may dominate at their loads; otherwise they are much weaker.
    sound = np.zeros(n)
    fall = rng.uniform(*row["fall_db"])
    for i in range(n_modes):
        levels = fall * np.arange(int(rng.integers(1, 6))) + rng.normal(0.0, 3.0) * (fall > -40.0)
        strengths = np.minimum(10.0 ** (levels / 20.0), 1.0)
        strengths[0] = 1.0
        further = rng.uniform(*row.get("further_db", (0.0, 0.0))) if i else 0.0
        part = carried(solved[i], float(frequency[i]), strengths, n, rate)
        sound += 10.0 ** (further / 20.0) * part
    contact = np.interp(np.arange(n) * (ENVELOPE_RATE / rate), np.arange(m), load)
    hiss = coloured_noise(n, rng.uniform(-0.5, 1.5), rng) * np.maximum(contact, 0.0)
    level = float(sound.std()) * 10.0 ** (rng.uniform(-62.0, -3.0) / 20.0)
    return np.asarray(sound + level * hiss)
