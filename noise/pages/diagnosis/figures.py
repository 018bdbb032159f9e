"""Measured against simulated, before and after: cycles of the torque, and levels in bands.

A before and an after are compared by eye only on common axes, and cycles only where they are
aligned: each torque is shown around a slip of its own, because no simulation can know when the
rig began to stick. Bands of a sixth of an octave are wide enough to be still and narrow enough to
show a resonance.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from features.kernels.bands import band_levels, band_power
from features.kernels.slip_drops import torque_slips
from features.kernels.spectra import autospectrum
from models.drawing import BLUE, VERMILION, padded, styled, thinned
from noise.pages.engine.panels import COLUMNS, Panel, as_svg, new_panel, panel_frequencies
from noise.pictures.channel_kinds import KINDS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from models.recording import Recording
    from noise.diagnosis.findings import Illustration

__all__ = ["CURVES", "Curve", "cycle_window", "draw", "illustration_panels", "sixth_octaves"]


@dataclass(frozen=True)
class Curve:
    """How one of the three is drawn, as no eye takes it for another; `width` in points."""

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
_SHORTEST, _LONGEST = 0.03, 0.05  # of the cycles shown [s]
_CYCLES = 3.0
_LEAD = 0.25  # of the window, before the slip
_RESOLUTION = 1.0  # [Hz]: three bins in the lowest band
_LEAST_BINS = 2.0
_RANGE = 70.0  # of a level axis at most [dB]
_ANTI_ALIAS = 0.9  # of the Nyquist frequency
_LEAST_SAMPLES = 16


def illustration_panels(illustration: Illustration) -> tuple[Panel, ...]:
    """Draw what an illustration has: cycles of the torque, and one spectrum a kind of channel.

    Parameters
    ----------
    illustration : Illustration

    Returns
    -------
    tuple of Panel
        The cycles first, where the recording has a torque.

    Raises
    ------
    ParameterError
        A signal that cannot be analysed.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> from noise.diagnosis.findings import Illustration
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
    """Levels in bands of a sixth of an octave, base ten, from 25 Hz to 15 kHz.

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
    kept = (high - low >= _LEAST_BINS * spectrum.spacing) & (high <= _ANTI_ALIAS * rate / 2.0)
    return middle[kept], level[kept]


def cycle_window(torque: NDArray[np.float64], rate: float, length: float) -> tuple[float, bool]:
    """Find where to show a torque.

    Parameters
    ----------
    torque : ndarray, shape (n_samples,)
        [N m]
    rate, length : float
        [Hz], [s]

    Returns
    -------
    start : float
        Such that the slip nearest to the middle lies a quarter of `length` behind it [s].
    aligned : bool
        False where there is no slip, and the middle is taken.

    Examples
    --------
    >>> t = np.arange(30000) / 30e3
    >>> start, aligned = cycle_window(8.0 + 2.7 * ((100.0 * t) % 1.0), 30e3, 0.04)
    >>> aligned, round(1e3 * (start + 0.01) % 10.0) % 10
    (True, 0)
    """
    duration = torque.size / rate
    times = torque_slips(torque, rate).times
    inside = times[(times >= _LEAD * length) & (times <= duration - (1.0 - _LEAD) * length)]
    if not inside.size:
        return max(0.0, 0.5 * (duration - length)), False
    slip = inside[np.abs(inside - 0.5 * duration).argmin()]
    return float(slip) - _LEAD * length, True


def _signal(recording: Recording, kind: str) -> NDArray[np.float64] | None:
    row = recording.first(kind)
    if row is None or recording.samples.shape[1] < _LEAST_SAMPLES:
        return None
    return np.asarray(recording.samples[row], dtype=np.float64)


def _cycles(runs: dict[str, Recording]) -> Panel:
    signals = {
        name: (signal, recording.rate)
        for name, recording in runs.items()
        if (signal := _signal(recording, "torque")) is not None
    }
    length = _length(*signals["measured"]) if "measured" in signals else _LONGEST
    figure, axes = new_panel(
        "Torque, around a slip of each", "Time from the slip [ms]", "Torque [Nm]"
    )
    unaligned, low, high = [], np.inf, -np.inf
    for name, (signal, rate) in signals.items():
        start, aligned = cycle_window(signal, rate, length)
        first = round(start * rate)
        piece = signal[first : first + round(length * rate) + 1]
        time = (np.arange(first, first + piece.size) / rate - start - _LEAD * length) * 1e3
        draw(axes, name, *thinned(time, piece, columns=COLUMNS))
        low, high = min(low, float(piece.min())), max(high, float(piece.max()))
        if not aligned:
            unaligned.append(CURVES[name].label)
    axes.set_xlim(-1e3 * _LEAD * length, 1e3 * (1.0 - _LEAD) * length)
    axes.set_ylim(*padded(low, high, 0.1))
    alt = f"Torque over {1e3 * length:.0f} ms around a slip, {low:.3g} to {high:.3g} Nm."
    if unaligned:
        text = f"no slip: {', '.join(unaligned)}"
        axes.set_xlabel(f"Time from the slip [ms]; {text}")
        if len(unaligned) == len(signals):
            axes.set_title("Torque, in which nothing slips", loc="left", fontweight="bold")
            axes.set_xlabel("Time [ms]")
        alt = f"{alt} There is {text}."
    return Panel(as_svg(figure), alt)


def _length(torque: NDArray[np.float64], rate: float) -> float:
    """Three cycles, or what of them a panel keeps apart."""
    slips = torque_slips(torque, rate)
    wanted = _CYCLES / slips.rate if slips.rate > 0.0 else _LONGEST
    return float(min(max(wanted, _SHORTEST), _LONGEST, torque.size / rate))


def _spectra(runs: dict[str, Recording], kind: str) -> Panel:
    about = KINDS[kind]
    reference = about.density.removesuffix("²/Hz").strip("()")
    figure, axes = new_panel(f"{about.name}, sixth octaves", "Frequency [Hz]", f"dB re {reference}")
    tops, bottoms, overall = [], [], []
    for name, recording in runs.items():
        signal = _signal(recording, kind)
        if signal is None:
            continue
        middle, level = sixth_octaves(signal, recording.rate, about.reference)
        level = np.where(np.isfinite(level), level, np.nan)
        draw(axes, name, middle, level)
        if np.isfinite(level).any():
            tops.append(float(np.nanmax(level)))
            bottoms.append(float(np.nanmin(level)))
        square = float(np.mean((signal - signal.mean()) ** 2))
        words = f"{float(band_levels(square, about.reference)):.1f} dB" if square else "silent"
        overall.append(f"{CURVES[name].label} {words}")
    if tops:
        top = 5.0 * np.ceil((max(tops) + 3.0) / 5.0)
        axes.set_ylim(max(5.0 * np.floor((min(bottoms) - 1.0) / 5.0), top - _RANGE), top)
    panel_frequencies(axes, _LOWEST, _HIGHEST)
    return Panel(as_svg(figure), f"{about.name} in sixth octaves: over all, {', '.join(overall)}.")


def draw(
    axes: Axes, role: str, x: NDArray[np.float64], y: NDArray[np.float64], marker: str = ""
) -> None:
    """Draw a curve as all of its role are drawn.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    role : str
        A key of `CURVES`.
    x, y : ndarray, shape (n,)
        In the units of the axes [-].
    marker : str
        Of matplotlib; none by default.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> axes = Figure().subplots()
    >>> draw(axes, "before", np.zeros(2), np.ones(2))
    >>> axes.lines[0].get_label()
    'nominal model'
    """
    curve = CURVES[role]
    style = (0.0, (4.0, 1.6)) if curve.dashed else "-"
    axes.plot(
        x, y, color=curve.colour, linewidth=curve.width, linestyle=style, label=curve.label,
        marker=marker, markersize=3.0,
    )  # fmt: skip
