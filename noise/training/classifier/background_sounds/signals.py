"""Sounds made to be heard: alarms, phones, sirens, horns, bells, steady tones, music.

They are as tonal as a squeal, but exact: a frequency that does not move or moves by a rule, a
switched rhythm, an attack within a cycle or an exponential decay, harmonics of one series or a
bell's partials, the notes of a scale.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from noise.training.classifier.background_sounds.building import blow, harmonics
from noise.training.draws import coloured_noise, log_uniform


def alarm(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Beeps of a clock, a phone, a reversing truck: bursts of one or two exact notes."""
    note = log_uniform(400.0, min(4500.0, 0.3 * rate), rng)
    period = log_uniform(0.06, 1.2, rng)
    duty = rng.uniform(0.3, 0.8)
    beep = (np.arange(n) / rate + rng.random() * period) / period
    on = (beep % 1.0) < duty
    if rng.random() < 0.5:  # in groups
        group = int(rng.integers(2, 9))
        on &= (beep.astype(int) % (group + int(rng.integers(1, 5)))) < group
    second = note * float(rng.choice((0.75, 0.8, 1.0, 1.0, 1.25, 1.5)))
    pitch = np.where(beep.astype(int) % 2 == 0, note, second)
    roll_off = rng.uniform(0.3, 4.0)
    sound = harmonics(pitch, rate, roll_off, n_most=10)
    m = max(1, int(rng.uniform(0.0005, 0.01) * rate))
    gate = np.convolve(on.astype(float), np.ones(m) / m, mode="same")
    if rng.random() < 0.25:  # a mechanical bell: struck some twenty times a second
        gate = gate * np.exp(-rng.uniform(1.0, 4.0) * ((beep * rng.integers(8, 25)) % 1.0))
        sound = sound + harmonics(2.76 * pitch, rate, 1.0, n_most=3)
    return np.asarray(sound * gate + 1e-4 * rng.standard_normal(n))


def siren(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Two notes in turn, a wail, or a yelp, with many harmonics."""
    time = np.arange(n) / rate + rng.random() * 3.0
    low = log_uniform(350.0, 900.0, rng)
    pace = log_uniform(0.15, 6.0, rng)
    kind = int(rng.integers(3))
    if kind == 0:
        course = ((time * pace) % 1.0 > 0.5) * 0.4
    elif kind == 1:
        course = 0.5 + 0.5 * np.sin(2 * np.pi * pace * time)
    else:
        course = (time * pace) % 1.0
    pitch = low * np.exp2(rng.uniform(0.5, 1.3) * course)
    sound = harmonics(pitch, rate, rng.uniform(0.5, 2.0), n_most=15)
    return np.asarray(sound + rng.uniform(0.0, 0.5) * coloured_noise(n, 1.2, rng))


def horn(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw a car's horn: one or two discs of 300 to 550 Hz, rich in harmonics, sounded by hand."""
    f0 = rng.uniform(280.0, 560.0)
    notes = (f0,) if rng.random() < 0.4 else (f0, f0 * rng.uniform(1.18, 1.3))
    gate = np.zeros(n)
    start = int(rng.uniform(0.0, 0.3) * rate) * int(rng.random() < 0.6)
    while start < n:
        m = int(log_uniform(0.1, 2.5, rng) * rate)
        gate[start : start + m] = 1.0
        start += m + int(log_uniform(0.05, 0.8, rng) * rate)
    m = max(1, int(rng.uniform(0.003, 0.03) * rate))
    gate = np.convolve(gate, np.ones(m) / m, mode="same")
    sound = np.zeros(n)
    for note in notes:
        sound += harmonics(np.full(n, note), rate, rng.uniform(0.0, 1.2), n_most=25)
    return np.asarray(sound * gate + rng.uniform(0.01, 0.4) * coloured_noise(n, 1.5, rng))


def bells(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Church bells, handbells, chimes: partials of a bell, struck, long in dying."""
    partials = np.array([0.5, 1.0, 1.19, 1.5, 2.0, 2.51, 2.66, 3.01, 4.17, 5.4])
    sound = np.zeros(n)
    time = np.arange(n) / rate
    for _ in range(int(rng.integers(1, 4))):
        strike = log_uniform(150.0, 2500.0, rng)
        lasting = log_uniform(0.3, 4.0, rng)
        weight = rng.uniform(0.1, 1.0, partials.size)
        first = -rng.uniform(0.0, 0.5)
        while first < n / rate:
            since = time - first
            on = since > 0.0
            for ratio, w in zip(partials, weight, strict=True):
                if ratio * strike < 0.45 * rate:
                    decay = np.exp(-np.where(on, since, 0.0) * (0.5 + 0.5 * ratio) / lasting)
                    sound += on * w * decay * np.sin(2 * np.pi * ratio * strike * since)
            first += log_uniform(0.4, 3.0, rng)
    return sound


def tone(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw a steady tone below 700 Hz, alone or with weak overtones: a fan, a generator, a test."""
    note = log_uniform(90.0, 700.0, rng)
    sound = harmonics(np.full(n, note), rate, rng.uniform(0.8, 4.0), int(rng.integers(1, 12)))
    level = 10.0 ** (rng.uniform(-50.0, -3.0) / 20.0)
    return np.asarray(sound + level * coloured_noise(n, rng.uniform(0.0, 2.0), rng))


def music(n: int, rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw notes of the tempered scale on a beat, decaying or held, now and then over drums."""
    sound = np.zeros(n)
    beat = log_uniform(0.1, 0.7, rng)
    held = rng.random() < 0.5
    roll_off = rng.uniform(0.7, 2.5)
    low, n_notes = int(rng.integers(0, 30)), int(rng.integers(1, 5))
    start = 0
    while start < n:
        length = beat * float(rng.choice((1, 1, 2, 4)))
        m = min(n - start, int((length if held else length + 1.0) * rate))
        time = np.arange(m) / rate
        for _ in range(n_notes):
            pitch = 55.0 * 2.0 ** ((low + rng.integers(0, 30)) / 12.0)
            if held:
                vibrato = rng.uniform(0.0, 0.012) * np.sin(2 * np.pi * rng.uniform(4.5, 7) * time)
                rise = np.minimum(1.0, np.minimum(time, time[::-1]) / rng.uniform(0.01, 0.08))
                note = rise * harmonics(pitch * (1.0 + vibrato), rate, roll_off, n_most=20)
            else:
                note = np.exp(-time / rng.uniform(0.08, 1.2)) * harmonics(
                    np.full(m, pitch), rate, roll_off, n_most=20
                )
            sound[start : start + m] += note
        start += int(length * rate)
    if rng.random() < 0.4:
        for at in np.arange(0.0, n / rate, beat):
            hit = blow(rate, (60.0, 5000.0), (0.01, 0.08), rng, noise=4.0)[: n - int(at * rate)]
            first = int(at * rate)
            sound[first : first + hit.size] += hit * rng.uniform(0.3, 2.0)
    return sound


RECIPES = (alarm, bells, horn, music, siren, tone)
"""Each takes the number of samples, the rate [Hz] and a generator."""
