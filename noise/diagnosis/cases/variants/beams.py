"""Further forms of what clamp and beams add: modes, waves, and modes that lie elsewhere."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import butter, fftconvolve, lfilter

from noise.diagnosis.cases.variants.common import (
    Array,
    Recipe,
    Rng,
    log_uniform,
    log_uniforms,
    on_chain,
)  # fmt: skip
from noise.diagnosis.cases.variants.paths import (
    damped,
    on_acceleration,
    rings,
    shifted,
    split,
    waveguide,
)
from sim.chain import HIGHEST_SHARE, padded_sum, resonance
from sim.effects.effect import Effect

if TYPE_CHECKING:
    from models.radiation.impulse_responses import ImpulseResponses


_CONSTANTS = (8.0, 100.0)
"""Modal constants at strength 1; that of the first torsional mode is about 100 [1/(kg m)]."""

_MASSES = (0.005, 0.15)
"""That the anchors feel for what the accelerometer sees [kg]."""


def _on_beams(
    form: str, a: float, change: Callable[[ImpulseResponses, Rng], ImpulseResponses]
) -> Effect:
    """Change what beams do; a clamp that is bolted down has none."""
    return on_chain(
        "beam_modes", form, a,
        lambda paths, rng: change(paths, rng) if np.any(paths.pulse_to_acceleration) else paths,
    )  # fmt: skip


def _with_modes(
    form: str, a: float, rng: Rng, modes: list[tuple[float, float, float]], *, heard: bool = True
) -> Effect:
    """Add modes: frequency [Hz], damping ratio, constant."""
    mass = log_uniform(rng, *_MASSES) * heard

    def change(paths: ImpulseResponses, _rng: Rng) -> ImpulseResponses:
        accelerations, forces = [paths.torque_to_acceleration], [np.zeros(1)]
        for frequency, damping, constant in modes:
            if frequency > HIGHEST_SHARE * paths.rate:
                continue
            mode = frequency, damping, paths.rate
            accelerations.append(a * constant * resonance([1.0, 0.0, 0.0], *mode))
            forces.append(a * mass * constant * resonance([0.0, 0.0, 1.0], *mode))
        return _with_force(paths, padded_sum(accelerations), padded_sum(forces))

    return _on_beams(form, a, change)


def _with_force(paths: ImpulseResponses, acceleration: Array, force: Array) -> ImpulseResponses:
    pressure = fftconvolve(force, paths.pulse_to_pressure)
    return replace(
        paths,
        torque_to_acceleration=acceleration,
        torque_to_pressure=padded_sum([paths.torque_to_pressure, pressure]),
    )


def _some(
    form: str, band: tuple[float, float], dampings: tuple[float, float], count: tuple[int, int],
    *, heard: bool = True,
) -> Recipe:  # fmt: skip
    """Add modes of a band, as many as drawn."""

    def recipe(a: float, rng: Rng) -> Effect:
        n = int(rng.integers(*count))
        sizes = log_uniform(rng, *_CONSTANTS) * rng.choice([-1.0, 1.0], n) * rng.uniform(0.2, 1, n)
        columns = (log_uniforms(rng, *band, n), log_uniforms(rng, *dampings, n), sizes)
        modes = list(zip(*(column.tolist() for column in columns), strict=True))
        return _with_modes(form, a, rng, modes, heard=heard)

    return recipe


def _pair(a: float, rng: Rng) -> Effect:
    frequency, constant = log_uniform(rng, 250.0, 8000.0), log_uniform(rng, *_CONSTANTS)
    damping = log_uniform(rng, 0.003, 0.03)
    other = frequency * (1.0 + float(rng.uniform(1.0, 8.0)) * damping)
    second = constant * float(rng.uniform(-1.0, 1.0))
    return _with_modes("split", a, rng, [(frequency, damping, constant), (other, damping, second)])


def _crowd(a: float, rng: Rng) -> Effect:
    n = int(rng.integers(15, 35))
    low = log_uniform(rng, 300.0, 4000.0)
    frequencies = rng.uniform(low, low * float(rng.uniform(2.0, 5.0)), n)
    constants = log_uniform(rng, 15.0, 80.0) / np.sqrt(n) * rng.standard_normal(n)
    damping = log_uniform(rng, 0.01, 0.05)
    pairs = zip(frequencies.tolist(), constants.tolist(), strict=True)
    return _with_modes("crowd", a, rng, [(f, damping, c) for f, c in pairs])


def _beam_waveguide(a: float, rng: Rng) -> Effect:
    first, constant = log_uniform(rng, 300.0, 3000.0), log_uniform(rng, *_CONSTANTS)
    reflection = float(rng.choice([-1.0, 1.0])) * (1.0 - log_uniform(rng, 0.02, 0.25))
    dullness, mass = float(rng.uniform(0.05, 0.5)), log_uniform(rng, *_MASSES)

    def change(paths: ImpulseResponses, _rng: Rng) -> ImpulseResponses:
        echoes = waveguide(paths.rate, first, reflection, dullness)
        b, c = butter(2, 2.0 * 0.4 * first / paths.rate, "highpass")
        acceleration = a * constant * np.asarray(lfilter(b, c, np.append(echoes, np.zeros(512))))
        b, c = butter(2, 2.0 * min(6.0 * first, 0.4 * paths.rate) / paths.rate)
        both = padded_sum([paths.torque_to_acceleration, acceleration])
        return _with_force(paths, both, mass * np.asarray(lfilter(b, c, acceleration)))

    return _on_beams("waveguide", a, change)


def _elsewhere(a: float, rng: Rng) -> Effect:
    """Have all modes higher or lower than they were measured: another length, another mass."""
    octaves = float(rng.choice([-1.0, 1.0]) * rng.uniform(0.1, 0.5)) * a
    return _on_beams("shifted", a, lambda paths, _rng: on_acceleration(
        paths, lambda h: shifted(h, 2.0**octaves)))  # fmt: skip


def _damped(a: float, rng: Rng) -> Effect:
    """Damp all modes more: a pad, a joint that rubs."""
    decay = a * log_uniform(rng, 100.0, 2000.0)
    return _on_beams("damped", a, lambda paths, _rng: on_acceleration(
        paths, lambda h: damped(h, paths.rate, decay)))  # fmt: skip


def _all_split(a: float, rng: Rng) -> Effect:
    """Split all modes in two, as a support does that is softer on one side."""
    apart = a * log_uniform(rng, 40.0, 600.0)
    return _on_beams("all_split", a, lambda paths, _rng: on_acceleration(
        paths, lambda h: split(h, paths.rate, apart)))  # fmt: skip


def _filters(form: str, senses: tuple[float, ...], most: float) -> Recipe:
    """Let structures in the way amplify bands of all acceleration, or swallow them."""

    def recipe(a: float, rng: Rng) -> Effect:
        n = int(rng.integers(1, 6))
        frequencies = log_uniforms(rng, 200.0, 9000.0, n).tolist()
        dampings = log_uniforms(rng, 0.005, 0.15, n).tolist()
        strengths = (most * rng.choice(senses, n) * rng.uniform(0.5, 1.0, n)).tolist()
        modes = list(zip(frequencies, dampings, strengths, strict=True))

        def change(paths: ImpulseResponses, _rng: Rng) -> ImpulseResponses:
            taps = padded_sum([np.ones(1), a * rings(paths.rate, modes)])
            return on_acceleration(paths, lambda h: fftconvolve(h, taps))

        return _on_beams(form, a, change)

    return recipe


# Bending and torsion of beams (Blevins 1979), dense fields of modes (Lyon and DeJong 1995), waves
# (Cremer and Heckl), absorbers and antiresonances (Den Hartog 1956).
BEAMS: tuple[Recipe, ...] = (
    _some("several", (300.0, 10e3), (0.004, 0.06), (2, 8)),
    _some("low", (40.0, 350.0), (0.005, 0.1), (1, 4)),
    _some("high", (4000.0, 14e3), (0.003, 0.03), (1, 5)),
    _some("unheard", (200.0, 10e3), (0.004, 0.06), (1, 5), heard=False),
    _some("soft", (200.0, 6000.0), (0.06, 0.4), (1, 4)),
    _pair, _crowd, _beam_waveguide, _elsewhere, _damped, _all_split,
    _filters("amplified", (-1.0, 1.0, 1.0), 8.0), _filters("swallowed", (-1.0,), 1.0),
)  # fmt: skip
