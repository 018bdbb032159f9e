"""Further forms of the way from torque to sound: modes, waves, and modes that lie elsewhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.ndimage import map_coordinates
from scipy.signal import butter, fftconvolve, lfilter

from sim.chain import HIGHEST_SHARE, filter_pressure, padded_sum, resonance


def _on_chain(a, change):
    """Change impulse responses; neutral at strength 0."""
    return {"chain": lambda paths, _form, _values, rng: change(paths, rng) if a > 0.0 else paths}


def _on_beams(a, change):
    """Change what beams do; a clamp that is bolted down has none."""
    return _on_chain(
        a, lambda paths, _rng: change(paths) if np.any(paths.pulse_to_acceleration) else paths
    )


def _modes(frequency, damping, strengths):
    """Modes: frequency [Hz], damping ratio (one may serve all), strength with its sense."""
    dampings = np.broadcast_to(damping, frequency.shape)
    return list(zip(frequency.tolist(), dampings.tolist(), strengths.tolist(), strict=True))


def waveguide(rate, first, reflection, dullness):
    """Impulse response of a way that a wave goes to and fro, its echoes without the first pass.

    Parameters
    ----------
    rate, first : float
        Sampling rate; how often a second it returns [Hz].
    reflection : float
        Signed, below 1 in magnitude [-].
    dullness : float
        From 0 to 0.5: of what is reflected, how much is smoothed away at the highest frequencies
        [-].

    Returns
    -------
    ndarray, shape (n,)
        Over the impulse [-].

    Examples
    --------
    >>> waveguide(8.0, 2.0, 0.5, 0.0)[:9]
    array([0.  , 0.  , 0.  , 0.  , 0.5 , 0.  , 0.  , 0.  , 0.25])
    """
    way = max(2, round(rate / first))
    passes = int(np.log(1e-4) / np.log(abs(reflection)))
    n = int(min(passes * way + way, max(0.25 * rate, 3 * way)))
    echoes = np.zeros(n)
    echo = reflection * np.array([0.5 * dullness, 1.0 - dullness, 0.5 * dullness])
    wave = echo
    for middle in range(way, n, way):
        half = wave.size // 2
        stop = min(middle + half + 1, n)
        echoes[middle - half : stop] += wave[: stop - middle + half]
        wave = np.convolve(wave, echo)
        if wave.size > 2 * way - 3:  # its far tails are as good as nothing
            wave = wave[1:-1]
    return echoes


def rings(rate, modes):
    """Sum of resonances of unit peak times their strength.

    Examples
    --------
    >>> rings(48e3, [(1000.0, 0.05, 0.0)]).any()
    np.False_
    """
    return padded_sum(
        [np.zeros(1)]
        + [
            strength * resonance([0.0, 2.0 * damping, 0.0], frequency, damping, rate)
            for frequency, damping, strength in modes
            if frequency < HIGHEST_SHARE * rate
        ]
    )


def moved(way, response, rate, amount):
    """Shift all modes of an impulse response, damp them, or split each in two.

    Parameters
    ----------
    way : {"shifted", "damped", "split"}
    response : ndarray, shape (n,)
        [any]
    rate : float
        Sampling rate [Hz].
    amount : float
        Octaves; faster decay [1/s]; how far the two lie apart [Hz].

    Returns
    -------
    ndarray, shape (n,)
        [as `response`]

    Examples
    --------
    >>> tone = np.sin(0.2 * np.arange(100.0))
    >>> higher = moved("shifted", tone, 1.0, 1.0)
    >>> bool(np.allclose(higher[9:50], 2.0 * np.sin(0.4 * np.arange(9, 50)), atol=0.01))
    True
    """
    if way == "damped":
        return response * np.exp(-amount / rate * np.arange(response.size))
    if way == "split":
        return response * np.cos(np.pi * amount / rate * np.arange(response.size))
    factor = 2.0**amount
    if factor == 1.0 or response.size == 1:
        return response
    at = factor * np.arange(response.size)
    return factor * map_coordinates(response, [at], order=3, mode="constant")


def _both(paths, of, change):
    """Change both ways to the acceleration, the sound stays; or both to the pressure."""
    ways = (f"torque_to_{of}", f"pulse_to_{of}")
    return replace(paths, **{way: change(getattr(paths, way)) for way in ways})


def beams(
    a,
    frequency,
    damping,
    signs,
    mass,
    constant=0.0,
    sizes=1.0,
    dense=0.0,
    *,
    audible=True,
    **_drawn,
):
    """Add modes of modal constants [1/(kg m)]; that of the first torsional mode is about 100."""
    n = frequency.size
    constants = dense / np.sqrt(n) * signs if dense else constant * signs * sizes
    return _with_modes(a, _modes(frequency, damping, constants), mass * audible)


def beam_pair(a, frequency, constant, damping, apart, second, mass):
    """Add two modes that lie close."""
    other = frequency * (1.0 + apart * damping)
    modes = [(frequency, damping, constant), (other, damping, constant * second)]
    return _with_modes(a, modes, mass)


def _with_modes(a, modes, mass):
    """Add modes; the anchors feel so much of the mass that the accelerometer sees [kg]."""

    def change(paths):
        accelerations, forces = [paths.torque_to_acceleration], [np.zeros(1)]
        for frequency, damping, constant in modes:
            if frequency > HIGHEST_SHARE * paths.rate:
                continue
            mode = frequency, damping, paths.rate
            accelerations.append(a * constant * resonance([1.0, 0.0, 0.0], *mode))
            forces.append(a * mass * constant * resonance([0.0, 0.0, 1.0], *mode))
        return _with_force(paths, padded_sum(accelerations), padded_sum(forces))

    return _on_beams(a, change)


def _with_force(paths, acceleration, force):
    pressure = fftconvolve(force, paths.pulse_to_pressure)
    return replace(
        paths,
        torque_to_acceleration=acceleration,
        torque_to_pressure=padded_sum([paths.torque_to_pressure, pressure]),
    )


def beam_waveguide(a, first, constant, sign, lost, dullness, mass):
    """Let a wave go to and fro in a beam."""
    reflection = sign * (1.0 - lost)

    def change(paths):
        echoes = waveguide(paths.rate, first, reflection, dullness)
        b, c = butter(2, 2.0 * 0.4 * first / paths.rate, "highpass")
        acceleration = a * constant * lfilter(b, c, np.append(echoes, np.zeros(512)))
        b, c = butter(2, 2.0 * min(6.0 * first, 0.4 * paths.rate) / paths.rate)
        both = padded_sum([paths.torque_to_acceleration, acceleration])
        return _with_force(paths, both, mass * lfilter(b, c, acceleration))

    return _on_beams(a, change)


def all_beams(a, way, amount, sign=1.0):
    """Change all modes of clamp and beams."""
    size = sign * amount * a
    return _on_beams(a, lambda paths: _both(
        paths, "acceleration", lambda h: moved(way, h, paths.rate, size)))  # fmt: skip


def all_plates(a, way, amount, sign=1.0):
    """Change all modes of what radiates: another thickness, warmer, bolted; a mat on the plate."""
    size = sign * amount * a
    return _on_chain(a, lambda paths, _rng: _both(
        paths, "pressure", lambda h: moved(way, h, paths.rate, size)))  # fmt: skip


def beam_filters(a, frequency, damping, signs, sizes, most, **_drawn):
    """Let structures in the way amplify bands of all acceleration, or swallow them."""
    modes = _modes(frequency, damping, most * signs * sizes)

    def change(paths):
        taps = padded_sum([np.ones(1), a * rings(paths.rate, modes)])
        return _both(paths, "acceleration", lambda h: fftconvolve(h, taps))

    return _on_beams(a, change)


def _plate_modes(n, most, frequency=None, signs=1.0, sizes=None, damping=0.0, first=0.0, power=0.0):
    """List modes: drawn ones, or ones that lie closer or wider the higher they are."""
    if frequency is None:
        frequency = first * np.arange(1.0, n + 1.0) ** power
    return _modes(frequency, damping, most * signs * (np.ones(n) if sizes is None else sizes))


def plates(a, **numbers):
    """Add to the direct sound what modes make of it; swallow bands where they are negative."""
    modes = _plate_modes(**numbers)
    return _echoing(a, lambda rate, _rng: rings(rate, modes))


def beside(a, **numbers):
    """Radiate by a part of its own that torque and pulses shake directly: a guard, a cover."""
    modes = _plate_modes(**numbers)

    def change(paths, _rng):
        own = a * rings(paths.rate, modes)
        return _both(paths, "pressure", lambda h: padded_sum([h, _band_level(h, paths.rate) * own]))

    return _on_chain(a, change)


def _band_level(response, rate):
    """Root mean square of what an impulse response passes in the band."""
    n = max(response.size, 2048)
    frequency = np.fft.rfftfreq(n, 1.0 / rate)
    inside = (frequency >= 200.0) & (frequency <= 6000.0)
    return float(np.sqrt(np.mean(np.abs(np.fft.rfft(response, n))[inside] ** 2)))


def louder_band(a, corner, kind, order, gain):
    """Radiate better above a coincidence, or below a cut."""

    def change(h, rate):
        b, c = butter(order, 2.0 * corner / rate, kind)
        return h + a * gain * lfilter(b, c, h)

    return _on_chain(
        a, lambda paths, _rng: _both(paths, "pressure", lambda h: change(h, paths.rate))
    )


def _echoing(a, taps):
    """Add to the direct sound what ``taps(rate, rng)`` makes of it."""
    return _on_chain(a, lambda paths, rng: filter_pressure(
        paths, padded_sum([np.ones(1), a * taps(paths.rate, rng)])))  # fmt: skip


def reflections(a, form, series="", **numbers):
    """Let the sound reach the microphone by further ways."""
    made = _TAPS[series or form]
    return _echoing(a, lambda rate, rng: made(rate, rng, **numbers))


def _plate_wave(rate, _rng, first, dullness, sign, reflection):
    size = 5.0 * (1.0 - abs(sign * reflection)) / abs(sign * reflection)
    return size * waveguide(rate, first, sign * reflection, dullness)


def _flutter(rate, _rng, first, dullness, reflection, size):
    """Go to and fro between two hard walls, duller each time."""
    return size / reflection * waveguide(rate, first, reflection, dullness)


def _spaced(times, gains, rate):
    """Echoes after so many seconds, each shared between two samples."""
    place = times * rate
    taps = np.zeros(int(place.max()) + 3)
    whole = place.astype(np.int64)
    np.add.at(taps, whole, gains * (1.0 - (place - whole)))
    np.add.at(taps, whole + 1, gains * (place - whole))
    return taps


def _decay(rate, rng, lasting, start):
    """Tail of unit energy that decays by 60 dB in its time [s]."""
    n = round(lasting * rate)
    tail = rng.standard_normal(n) * np.exp(-6.9 * np.arange(n) / n)
    return np.concatenate([np.zeros(max(1, round(start * rate))), tail / np.sqrt((tail**2).sum())])


def _diffuse(rate, rng, lasting, size):
    """Ring along as a whole field of modes that overlap."""
    n = round(lasting * rate)
    tail = rng.standard_normal(n) * np.exp(-6.9 * np.arange(n) / n)
    return size * tail / np.sqrt((tail**2).sum())


def _corridor(rate, _rng, way, wall, side, apart):
    orders = np.arange(1.0, 1.0 + int(np.log(1e-3) / np.log(wall)))
    flutter = _spaced(orders * way, 3.0 * wall**orders / np.sqrt(orders), rate)
    few = np.arange(1.0, 4.0)
    return padded_sum([flutter, _spaced(few * (apart * way), 3.0 * side**few, rate)])


def _few(rate, _rng, n, times, signs, sizes):
    return _spaced(times, 5.0 * signs * sizes / np.sqrt(n), rate)


def _one(rate, _rng, time, gain, size, corner):
    """Reflect once, from a wall, a bench or the floor: a comb."""
    b, c = butter(1, min(2.0 * corner / rate, 0.95))
    echo = np.append(_spaced(np.array([time]), np.array([gain * size]), rate), np.zeros(256))
    return lfilter(b, c, echo)


def _standing(rate, _rng, n, lowest, apart, damping, signs, sizes, delay):
    """Stand in the room at its lowest modes (Morse and Bolt 1944)."""
    modes = _modes(lowest * (1.0 + np.cumsum(apart)), damping, 8.0 * signs * sizes)[:n]
    return np.concatenate([np.zeros(round(delay * rate)), rings(rate, modes)])


def _coupled(rate, rng, fast, slow, starts, share, size):
    """Decay twice: a room beside the room, or a booth with its door open (Eyring 1931)."""
    near, far = _decay(rate, rng, fast, starts[0]), _decay(rate, rng, slow, starts.sum())
    return size * padded_sum([(1.0 - share) * near, share * far])


def _coloured(rate, rng, lasting, start, corner, kind, size):
    """Add a tail of which the high frequencies, or the low ones, are absorbed."""
    b, c = butter(1, 2.0 * corner / rate, kind)
    return size * lfilter(b, c, _decay(rate, rng, lasting, start))


def _early_and_late(rate, rng, n, lasting, times, gains, late, size):
    """Reflect by single walls first, and as a tail after (Moorer 1979)."""
    early = _spaced(times[:n], gains * np.exp(-times / 0.03), rate)
    return size * padded_sum([early, late * _decay(rate, rng, lasting, 0.02)])


_TAPS = {
    "plate_wave": _plate_wave, "diffuse": _diffuse, "corridor": _corridor, "few": _few, "one": _one,
    "flutter": _flutter, "standing": _standing, "coupled": _coupled, "coloured": _coloured,
    "early_and_late": _early_and_late,
    "booth": lambda rate, rng, lasting, start, size: size * _decay(rate, rng, lasting, start),
}  # fmt: skip
