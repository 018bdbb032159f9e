"""Picture of a run: time histories and autospectra.

Time histories show the motion as it was computed, which no sensor sees;
autospectra show what the sensors recorded, up to half the sampling rate. A linear axis would hide
the slips' harmonics below 2 kHz or a creak's rattle above, so frequencies are on a logarithmic one.

A few slips are shown enlarged. At constant speed any part is as good, and the middle is taken. A
shaft that swings or runs up is quiet for most of the time; there it is the part about the largest
acceleration of the beam.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from features.kernels.harmonics import analyse_harmonics
from features.kernels.spectra import autospectrum
from models.condition import Condition
from models.drawing import BLUE, GREY, ORANGE, frequency_axis, levels, padded, styled, thinned
from models.recording import Recording
from noise.pictures.figure import KINDS, new_figure
from sim.analysis.regime import LEAST_OSCILLATION, motion_slips
from sim.motion import Motion
from sim.run import Curve, Run, torque_curves

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

_CYCLES = 6
_SHORTEST, _LONGEST = 2e-3, 0.1
_WITHOUT_CYCLES = 0.04
"""Length of a window [s]."""

_AROUND = 0.25
"""How much of the run on either side the period is taken from [s]."""

_LEAST_SAMPLES = 1000
"""In which a period is sought."""


@dataclass(frozen=True)
class Window:
    """Interval of a motion.

    Parameters
    ----------
    first, last : int
        Samples of the motion, `last` being the first one after it.
    frequency : float, optional
        Repetition rate of slips, or of the oscillation, thereabouts [Hz].
    """

    first: int
    last: int
    frequency: float | None


def run_window(run: Run) -> Window:
    """Return the interval of a run that is shown enlarged.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> run = simulate(load_material_rig("fluorocarbon-thesis"), 1.0, support_stiffness=3745.0)
    >>> window = run_window(run)
    >>> round(window.frequency), round((window.last - window.first) / run.motion.rate, 3)
    (150, 0.04)
    """
    motion, recording = run.motion, run.recording
    n, rate = motion.torque.size, motion.rate
    middle = n // 2
    if recording.condition.speed is None:
        loudest = int(np.argmax(np.abs(recording["acceleration"])))
        middle = min(round(loudest * rate / recording.rate), n - 1)
    reach = round(_AROUND * rate)
    frequency = _cycles(motion.part(max(0, middle - reach), middle + reach))
    seconds = _WITHOUT_CYCLES
    if frequency is not None:
        seconds = min(max(_CYCLES / frequency, _SHORTEST), _LONGEST)
    size = min(n, round(seconds * rate))
    first = min(max(0, middle - size // 2), n - size)
    return Window(first, first + size, frequency)


def _cycles(motion: Motion) -> float | None:
    """Return the rate of slips or torque periods [Hz]; None without oscillation."""
    if motion.torque.size < _LEAST_SAMPLES or not oscillates(motion.torque):
        return None
    rate = motion_slips(motion).rate
    if math.isnan(rate):
        rate = analyse_harmonics(motion.torque, motion.rate).fundamental
    return None if math.isnan(rate) else rate


def oscillates(torque: NDArray[np.floating]) -> bool:
    """Whether a torque oscillates, by `sim.analysis.regime`."""
    return bool(np.std(torque) > LEAST_OSCILLATION * abs(np.mean(torque)))


_LOWEST = 20.0
"""Left end of the frequency axes [Hz]."""

_DYNAMIC_RANGE = 120.0
"""Of a spectrum's axis at most [dB]."""

_LEAST_TORQUE, _LEAST_ANGLE, _LEAST_SPEED = 0.1, 0.1, 0.1
"""What an axis spans at least [Nm], [mrad], [rad/s]."""


def plot_run(run: Run) -> Figure:
    """Draw a simulated run.

    Parameters
    ----------
    run : Run
        Of any material, law, effect and motion of the shaft.

    Returns
    -------
    matplotlib.figure.Figure
        Torque, displacements and sliding speed over time, the whole run and beside it a few slips;
        autospectra of torque, acceleration and sound pressure, one-sided, as levels in dB. It
        belongs to no window and to no pyplot; ``figure.savefig("run.png")`` writes it.

    Notes
    -----
    After Figures 5.1, 5.21 to 5.24, and 6.1 to 6.9.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> figure = plot_run(simulate(load_material_rig("fluorocarbon-thesis"), 1.0, seconds=0.2))
    >>> figure.get_suptitle()
    'fluorocarbon-thesis, 0.279 mm, 2214 Nm/rad, 1 rad/s'
    """
    window = run_window(run)
    with styled():
        figure = new_figure(13.0, condition_words(run.recording.condition, run.motion))
        parts = figure.subfigures(2, 1, squeeze=False, height_ratios=(6.6, 6.4))
        histories, spectra = parts[:, 0]
        _histories(histories, run.motion, window)
        _spectra(spectra, run, window)
    return figure


def condition_words(condition: Condition, motion: Motion) -> str:
    """Return material, interference, support and speed as a title.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> from sim.shaft import SpeedRamp
    >>> run = simulate(load_material_rig("PDMS"), SpeedRamp(0.0, 5.0, 0.1), seconds=0.1)
    >>> condition_words(run.recording.condition, run.motion)
    'PDMS, 0.279 mm, 2214 Nm/rad, 0 to 5 rad/s'
    """
    words = condition.words
    if condition.speed is None:
        low, high = float(motion.shaft_speed.min()), float(motion.shaft_speed.max())
        words.append(f"{low:.3g} to {high:.3g} rad/s")
    return ", ".join(words)


def _histories(figure: SubFigure, motion: Motion, window: Window) -> None:
    """Draw torque, displacement and sliding speed over the run and over a few slips."""
    rate = motion.rate
    start, end = window.first / rate, window.last / rate
    whole, zoom = slice(0, motion.torque.size), slice(window.first, window.last)
    time = np.arange(motion.torque.size) / rate
    axes = figure.subplots(3, 2, sharex="col", sharey="row")
    for column, part, shown in zip(
        axes.T, (whole, zoom), (time, 1e3 * (time[zoom] - start)), strict=True
    ):
        for row, curves in zip(column, _motion_curves(motion, part), strict=True):
            for values, colour, label, width in curves:
                row.plot(
                    *thinned(shown, values), color=colour, linewidth=width, label=label or None
                )
        column[-1].set_xlim(shown[0], shown[-1])
    cycles = "" if window.frequency is None else f", {window.frequency:.4g} cycles a second"
    axes[0, 0].set_title("Whole run")
    axes[0, 1].set_title(f"Part of it{cycles}")
    axes[-1, 0].set_xlabel("Time [s]")
    axes[-1, 1].set_xlabel(f"Time from {start:.4g} s [ms]")
    names = ("Torque [Nm]", "Displacement [mrad]", "Speed [rad/s]")
    least = (_LEAST_TORQUE, _LEAST_ANGLE, _LEAST_SPEED)
    for row, name, smallest, curves in zip(
        axes[:, 0], names, least, _motion_curves(motion, whole), strict=True
    ):
        row.axvspan(start, end, color="black", alpha=0.3, linewidth=0, zorder=3)
        row.set_ylabel(name)
        row.set_ylim(_limits([values for values, *_ in curves], smallest))
        _legend_above(row)
    figure.align_ylabels(axes[:, 0])


def _motion_curves(motion: Motion, part: slice) -> tuple[list[Curve], ...]:
    """Return the curves of the time histories; later ones are drawn on top."""
    displacements: list[Curve] = [
        (1e3 * motion.interface_angle[part], BLUE, "elastomer's surface", 1.3)
    ]
    if np.any(motion.clamp_angle):
        displacements.append((1e3 * motion.clamp_angle[part], ORANGE, "clamp", 1.3))
    return (
        torque_curves(motion, part),
        displacements,
        [
            (motion.sliding_speed[part], BLUE, "sliding (shaft - surface)", 1.3),
            (motion.shaft_speed[part], GREY, "shaft", 1.0),
        ],
    )


def _spectra(figure: SubFigure, run: Run, window: Window) -> None:
    """Draw the autospectra of the recorded channels."""
    recording = run.recording
    rows = figure.subplots(len(KINDS), 1, sharex=True)
    cycles = window.frequency if recording.condition.speed is not None else None
    title = "Autospectra: one-sided power spectral density, Hann window, "
    for axes, kind in zip(rows, KINDS, strict=True):
        words = draw_spectrum(axes, recording, kind)
        if cycles is not None:
            axes.axvline(cycles, color=GREY, linestyle="--", linewidth=1.0, zorder=1)
    if cycles is not None:
        words += f"; dashed: {cycles:.4g} cycles a second"
    rows[0].set_title(title + words)
    rows[-1].set_xlabel("Frequency [Hz]")
    figure.align_ylabels(rows)


def draw_spectrum(axes: Axes, recording: Recording, name: str) -> str:
    """Draw the autospectrum of a channel on axes; return its settings."""
    kind = KINDS[name]
    spectrum = autospectrum(recording[name], recording.rate)
    shown = spectrum.frequency >= max(_LOWEST, spectrum.spacing)
    frequency, level = spectrum.frequency[shown], levels(spectrum.density[shown], kind.reference)
    axes.plot(
        *thinned(frequency, level, position=np.log(frequency)), color=kind.colour, linewidth=1.0
    )
    top = 10.0 * math.ceil((float(level.max()) + 3.0) / 10.0)
    bottom = 10.0 * math.floor((float(level.min()) - 3.0) / 10.0)
    axes.set_ylim(max(bottom, top - _DYNAMIC_RANGE), top)
    frequency_axis(axes, float(min(frequency[0], recording.rate / 4)), recording.rate / 2)
    axes.set_ylabel(f"{kind.name}\n[dB re {kind.density}]")
    return f"bins of {spectrum.spacing:.4g} Hz, mean of {spectrum.n_segments}"


def _limits(curves: Sequence[NDArray[np.float64]], least: float) -> tuple[float, float]:
    low, high = min(float(c.min()) for c in curves), max(float(c.max()) for c in curves)
    return padded(low, high, least)


def _legend_above(axes: Axes) -> None:
    """Place the legend above the axes, right of the title."""
    axes.legend(
        loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, borderaxespad=0.1, columnspacing=1.0
    )
