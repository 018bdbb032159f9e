"""Figures and sounds that compare recordings with simulations on the page of a diagnosis.

All curves of a quantity share axes. Torques are aligned at a slip, because the phase of stick-slip
is random. Bands of a sixth of an octave are wide enough to be smooth and narrow enough to show a
resonance. Loudness is not matched, since it is part of an effect: all sounds share one full scale.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from features.kernels.levels import band_levels, band_power
from features.kernels.spectra import autospectrum
from features.kernels.weighting import a_weighted_level
from models.drawing import BLUE, VERMILION, padded, styled, thinned
from models.recording import Recording
from noise.audio.sound import RATE, audible
from noise.diagnosis.outcome import ROLES, Illustration
from noise.diagnosis.words import number
from noise.pages import blocks as b
from noise.pages.cards import facts_of
from noise.pages.clips import Clip, Entry, common_gain, make_clips
from noise.pages.figures import COLUMNS, LEAD, Line, Panel, cycle_window, lines_panel
from noise.pictures.figure import KINDS

if TYPE_CHECKING:
    from noise.diagnosis.outcome import Diagnosis


@dataclass(frozen=True)
class Curve:
    """Style of a curve; `width` in points."""

    label: str
    colour: str
    width: float
    dashed: bool


CURVES = {
    "measured": Curve("measured", "#222222", 2.8, dashed=False),
    "before": Curve("nominal model", VERMILION, 1.5, dashed=True),
    "after": Curve("fitted model", BLUE, 1.5, dashed=False),
}
"""Near-black, vermilion and blue (Okabe and Ito, Color universal design, 2008), and dashes."""

_LOWEST, _HIGHEST = 25.0, 15e3  # mid-band frequencies [Hz]
_SHOWN = 0.04  # of the torque [s]
_RESOLUTION = 1.0  # [Hz]: three bins in the lowest band
_LEAST_BINS = 2.0
_RANGE = 70.0  # of a level axis at most [dB]
_ANTI_ALIAS = 0.9  # of the Nyquist frequency
_LEAST_SAMPLES = 16


def illustration_panels(illustration: Illustration) -> tuple[Panel, ...]:
    """Draw cycles of the torque and one spectrum for each kind of channel.

    Parameters
    ----------
    illustration : Illustration

    Returns
    -------
    tuple of Panel
        Cycles first, if the recording has a torque.

    Raises
    ------
    ParameterError
        A signal that cannot be analysed.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> from noise.diagnosis.outcome import Illustration
    >>> hiss = Recording(np.random.default_rng(1).normal(size=(1, 9600)), 48e3,
    ...                  (Channel("pressure"),))
    >>> (panel,) = illustration_panels(Illustration("hiss", hiss, hiss, None))
    >>> panel.alt[:46]
    'Sound pressure in sixth octaves: over all, mea'
    """
    runs = {role: run for role in CURVES if (run := getattr(illustration, role)) is not None}
    measured = illustration.measured
    with styled():
        panels = [_cycles(runs)] if measured.first("torque") is not None else []
        panels += [_spectra(runs, kind) for kind in KINDS if measured.first(kind) is not None]
    return tuple(panels)


def sixth_octaves(
    signal: NDArray[np.float64], rate: float, reference: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return levels in bands of a sixth of an octave, base ten, from 25 Hz to 15 kHz.

    Parameters
    ----------
    signal : ndarray, shape (n_samples,)
        In any unit, such as [Pa].
    rate : float
        [Hz]
    reference : float
        Of the levels, in the signal's unit, such as [Pa].

    Returns
    -------
    middle, level : ndarray, shape (n_bands,)
        Mid-band frequencies [Hz] and levels [dB], of the bands that the signal is long enough for
        and that lie below what an anti-aliasing filter takes away.

    Examples
    --------
    >>> tone = np.sin(2 * np.pi * 1059 * np.arange(48000) / 48e3)
    >>> middle, level = sixth_octaves(tone, 48e3, 1.0)
    >>> round(float(middle[level.argmax()])), round(float(level.max()))
    (1059, -3)
    """
    spectrum = autospectrum(signal, rate, resolution=_RESOLUTION)
    first, last = np.ceil(20.0 * np.log10(np.array([_LOWEST, _HIGHEST]) / 1e3) - 0.5)
    middle = 1e3 * 10.0 ** ((np.arange(first, last) + 0.5) / 20.0)
    low, high = middle / 10.0**0.025, middle * 10.0**0.025
    level = band_levels(band_power(spectrum, low, high), reference)
    valid = (high - low >= _LEAST_BINS * spectrum.spacing) & (high <= _ANTI_ALIAS * rate / 2.0)
    return middle[valid], level[valid]


def _signal(recording: Recording, kind: str) -> NDArray[np.float64] | None:
    row = recording.first(kind)
    if row is None or recording.samples.shape[1] < _LEAST_SAMPLES:
        return None
    return np.asarray(recording.samples[row], dtype=np.float64)


def _line(role: str, x: NDArray[np.float64], y: NDArray[np.float64]) -> Line:
    """Return a curve in the style of its role."""
    curve = CURVES[role]
    style = (0.0, (4.0, 2.0)) if curve.dashed else "-"
    return Line(x, y, curve.colour, curve.label, curve.width, style)


def _cycles(runs: dict[str, Recording]) -> Panel:
    lines, slips, low, high = [], True, np.inf, -np.inf
    for name, recording in runs.items():
        signal, rate = _signal(recording, "torque"), recording.rate
        if signal is None:
            continue
        start, aligned = cycle_window(signal, rate, _SHOWN)
        first = round(start * rate)
        piece = signal[first : first + round(_SHOWN * rate) + 1]
        time = (np.arange(first, first + piece.size) / rate - start - LEAD * _SHOWN) * 1e3
        lines.append(_line(name, *thinned(time, piece, columns=COLUMNS)))
        low, high = min(low, float(piece.min())), max(high, float(piece.max()))
        slips &= aligned
    title, across = ("Torque", "Time [ms]")
    if slips:
        title, across = "Torque, around a slip of each", "Time from the slip [ms]"
    return lines_panel(
        title, across, "Torque [Nm]", lines,
        f"{title}: {low:.3g} to {high:.3g} Nm over {1e3 * _SHOWN:.0f} ms.",
        across_ends=(-1e3 * LEAD * _SHOWN, 1e3 * (1.0 - LEAD) * _SHOWN),
        up_ends=padded(low, high, 0.1),
    )  # fmt: skip


def _spectra(runs: dict[str, Recording], kind: str) -> Panel:
    about = KINDS[kind]
    reference = about.density.removesuffix("²/Hz").strip("()")
    lines, overall, ends = [], [], None
    for name, recording in runs.items():
        signal = _signal(recording, kind)
        if signal is None:
            continue
        middle, level = sixth_octaves(signal, recording.rate, about.reference)
        lines.append(_line(name, middle, np.where(np.isfinite(level), level, np.nan)))
        square = float(np.mean((signal - signal.mean()) ** 2))
        words = f"{float(band_levels(square, about.reference)):.1f} dB" if square else "silent"
        overall.append(f"{CURVES[name].label} {words}")
    known = np.concatenate([one.y[np.isfinite(one.y)] for one in lines] or [np.empty(0)])
    if known.size:
        top = 5.0 * math.ceil((float(known.max()) + 3.0) / 5.0)
        ends = max(5.0 * math.floor((float(known.min()) - 1.0) / 5.0), top - _RANGE), top
    return lines_panel(
        f"{about.name}, sixth octaves", "Frequency [Hz]", f"dB re {reference}", lines,
        f"{about.name} in sixth octaves: over all, {', '.join(overall)}.",
        up_ends=ends, frequencies=(_LOWEST, _HIGHEST),
    )  # fmt: skip


LONGEST = 4.0
"""Longest sound on the page [s]: of longer ones the beginning is played."""


def illustration_entries(illustration: Illustration) -> dict[str, Entry]:
    """Return the sounds of an illustration, by role.

    Parameters
    ----------
    illustration : Illustration

    Returns
    -------
    dict of str to Entry
        Keys are ``measured``, ``before`` and ``after``, where there is a sound.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> from noise.diagnosis.outcome import Illustration
    >>> hiss = Recording(np.random.default_rng(1).normal(size=(1, 480)), 48e3,
    ...                  (Channel("pressure"),))
    >>> found = illustration_entries(Illustration("hiss", hiss, hiss, None))
    >>> [(role, entry.title) for role, entry in found.items()]
    [('measured', 'hiss, measured'), ('before', 'hiss, nominal model')]
    """
    entries = {}
    for role in ROLES:
        recording = getattr(illustration, role)
        if recording is not None and recording.first("pressure") is not None:
            sound = audible(recording)[: round(LONGEST * RATE)].astype(np.float32)
            level = a_weighted_level(recording["pressure"], recording.rate)
            entries[role] = Entry(
                f"{illustration.name}, {CURVES[role].label}",
                duration=sound.size / RATE,
                sound=sound,
                note=f"{number(level, '.1f')} dB(A)" if math.isfinite(level) else "",
            )
    return entries


def draw_comparisons(
    diagnosis: Diagnosis,
) -> tuple[dict[str, Entry], dict[str, Clip], list[b.Block]]:
    """Return figures and sounds of the illustrations of a diagnosis.

    Parameters
    ----------
    diagnosis : Diagnosis

    Returns
    -------
    entries : dict of str to Entry
        By id.
    clips : dict of str to Clip
        Clips of the audible ones.
    shown : list of Block
        Comparison of each recording with its simulations.

    Raises
    ------
    ParameterError
        A signal that cannot be analysed.
    """
    entries: dict[str, Entry] = {}
    groups: list[b.Block] = []
    for illustration in diagnosis.illustrations:
        sounds = illustration_entries(illustration)
        keys = [f"s{len(entries) + i}" for i in range(1, len(sounds) + 1)]
        entries |= dict(zip(keys, sounds.values(), strict=True))
        known = facts_of(Entry(illustration.name, condition=illustration.measured.condition))
        silent = "" if sounds else "There is no sound pressure to be heard."
        groups.append(
            b.Group(
                illustration.name,
                [
                    b.Cards(keys, "narrow"),
                    b.Text(silent, "soft small"),
                    b.Panels(illustration_panels(illustration)),
                ],
                ", ".join(words for name, words in known.items() if name != "material"),
                "compared",
            )
        )
    if not groups:
        return {}, {}, []
    gain = common_gain(entries.values())
    clips = make_clips(entries, gain)
    curves = b.Other("curves", list(CURVES.values()))
    return (
        entries,
        clips,
        [b.Sounds(gain.sentences if clips else (), labels=()), curves, *groups],
    )
