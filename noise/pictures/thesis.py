"""Data figures of the thesis, drawn by the plots of runs and sweeps.

Its Figures 5.1 to 5.26 and H1 are measurements, 6.1 to 6.10 computed; here all are computed.
Recordings of Chapter 5 are of the materials as they are shipped, runs of Chapter 6 and static tests
of the thesis's own model, and torque over speed of the materials' constant version. What a table or
the text says of a figure stands in the table of `noise.thesis.table`. Where caption and text of a
figure contradict each other the caption is followed: of 6.1 the text has 3745 Nm/rad, of 5.16(b) as
well.

A further figure is a further entry of `RUNS`, `SPECTRA` or `SWEEPS`.
"""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from scipy.fft import rfft, rfftfreq

from models.condition import FIXED
from models.drawing import styled
from models.radiation.rig_response import impulse_responses
from models.rig_file import load_material_rig
from models.transfer_functions.transfer_function import TransferFunction
from noise.pictures.figure import new_figure, support_words
from noise.pictures.run import draw_spectrum, plot_run
from noise.thesis.runs import CALIBRATED, LONG, SHORT, THESIS, Case, rig_of
from sim.analysis.critical_damping import critical_damping, with_damping
from sim.analysis.sweep import sweep
from sim.run import Run, simulate

_NEW, _FILM, _CLEANED = "natural-rubber", "natural-rubber-film", "natural-rubber-film-removed"
_FITS, _SUPPORTS = (0.178, 0.279, 0.381), (LONG, SHORT, FIXED)
"""[mm] and [Nm/rad]"""

_STATIC_SPEED = 0.05
"""Of the shaft in a static test [rad/s]."""

_CRITICAL = math.nan
"""Stands for the damping at which stick-slip ends."""

_AUDIBLE, _RADIATION_RATE = (20.0, 15e3), 96e3
"""Span of the acoustic responses, and the rate of their computation [Hz]."""


def _at_speeds(fit: float, support: float, *speeds: float) -> list[Case]:
    return [Case(speed, fit, support) for speed in speeds]


def _at_supports(fit: float, speed: float) -> list[Case]:
    return [Case(speed, fit, support) for support in _SUPPORTS]


_FOUR_TYPES = [
    Case(1.0, 0.279, FIXED),
    Case(1.0, 0.279, SHORT),
    Case(4.3, 0.178),
    Case(7.9, 0.279, SHORT),
]
"""Stick-slip, with feedback, triangular and harmonic."""


class Runs(NamedTuple):
    """Figure of runs, drawn by `noise.pictures.run`.

    Parameters
    ----------
    material : str
    cases : sequence of Case
        Pictures of single runs have a letter each, where there are several.
    seconds : float
        Length of each [s].
    from_rest : bool
        Whether the start is shown; otherwise the rig has settled.
    """

    material: str
    cases: Sequence[Case]
    seconds: float = 1.0
    from_rest: bool = False


RUNS = {
    "5.1": Runs(CALIBRATED, _FOUR_TYPES),
    "5.4": Runs("PDMS", [Case(0.25, 0.381)]),
    "5.7": Runs(_NEW, [Case(10.0, 0.127)]),
    "5.8": Runs(_NEW, [Case(5.0, 0.127)]),
    "5.9": Runs(_FILM, [Case(2.5, 0.127)]),
    "5.19": Runs(_CLEANED, [Case(10.0, 0.127)]),
    "5.21": Runs(CALIBRATED, [Case(1.0, 0.381)]),
    "5.22": Runs(CALIBRATED, [Case(5.0, 0.279)]),
    "5.23": Runs(CALIBRATED, [Case(5.0, 0.279, SHORT)]),
    "5.24": Runs(CALIBRATED, [Case(10.0, 0.279, SHORT)]),
    "5.25": Runs(THESIS, _at_supports(0.279, _STATIC_SPEED), 2.0, from_rest=True),
    "5.26": Runs(THESIS, _at_supports(0.381, _STATIC_SPEED), 2.0, from_rest=True),
    "6.1-6.3": Runs(THESIS, [Case(1.0)]),
    "6.4-6.6": Runs(THESIS, [Case(10.0)], 0.2, from_rest=True),
    "6.7": Runs(THESIS, [Case(1.0, 0.381, SHORT)]),
    "6.8-6.9": Runs(CALIBRATED, [Case(1.0)]),
    "6.10": Runs(
        THESIS,
        [Case(7.5, 0.279, SHORT, damping) for damping in (0.05, _CRITICAL, 0.1)],
        0.2,
        from_rest=True,
    ),
}
"""By the numbers of the figures: histories, phase planes and autospectra of each run."""

SPECTRA = {
    "5.2": Runs(CALIBRATED, _FOUR_TYPES),
    "5.14": Runs(CALIBRATED, _at_speeds(0.279, LONG, 1.0, 2.5, 5.0, 7.5)),
    "5.15": Runs(
        CALIBRATED, [Case(1.0, fit, support) for support in (LONG, FIXED) for fit in _FITS]
    ),
    "5.16": Runs(
        CALIBRATED,
        [*_at_speeds(0.178, LONG, 1.0, 2.5, 4.0), *_at_speeds(0.178, FIXED, 1.0, 2.5, 4.0)],
    ),
    "5.17": Runs(CALIBRATED, _at_speeds(0.279, FIXED, 1.0, 2.5, 5.0, 7.5)),
    "5.18": Runs(CALIBRATED, [*_at_supports(0.178, 2.5), *_at_supports(0.279, 7.5)]),
    "5.20": Runs(_CLEANED, [Case(10.0, 0.127), Case(10.0, 0.127, SHORT)]),
}
"""By the numbers of the figures: autospectra of the torque, one below the other."""


class Swept(NamedTuple):
    """Figure of torque and slip frequency over speed, drawn by `sim.analysis.sweep.Sweep.plot`.

    Parameters
    ----------
    material : str
    speeds : tuple of float
        The slowest and the fastest [rad/s].
    fits, supports : sequence of float
        [mm] and [Nm/rad], a curve for each pair.
    """

    material: str
    speeds: tuple[float, float]
    fits: Sequence[float]
    supports: Sequence[float]


SWEEPS = {
    "figure-5.3": Swept(CALIBRATED, (0.5, 13.0), _FITS, [FIXED]),
    **{f"speeds-{fit:g}mm": Swept(CALIBRATED, (0.5, 13.0), [fit], _SUPPORTS) for fit in _FITS},
    "figure-5.5": Swept("PDMS", (0.25, 17.0), [0.254], [LONG, FIXED]),
    "figure-5.6": Swept("PDMS", (0.25, 17.0), [0.381], [LONG, FIXED]),
    "figure-5.13": Swept(_CLEANED, (1.0, 19.75), [0.127], [LONG, SHORT]),
}
"""By the names of the pictures."""

_STEPS = 25
"""Speeds of a sweep."""

N_PICTURES = sum(len(shown.cases) for shown in RUNS.values()) + len(SPECTRA) + len(SWEEPS) + 1


def thesis_pictures() -> Iterator[tuple[str, Figure]]:
    """Draw the figures of the thesis.

    Yields
    ------
    name : str
        Such as ``"figure-5.22"``, with a letter where a figure shows several runs,
        ``"figure-5.14a"``; sweeps of a fit, on all supports, are ``"speeds-0.279mm"``.
    figure : matplotlib.figure.Figure
    """
    for number, shown in RUNS.items():
        for i, case in enumerate(shown.cases):
            letter = chr(ord("a") + i) if len(shown.cases) > 1 else ""
            figure = plot_run(_simulated(shown, case))
            figure.suptitle(f"Figure {number}{letter}: {figure.get_suptitle()}")
            yield f"figure-{number}{letter}", figure
    for number, shown in SPECTRA.items():
        yield f"figure-{number}", torque_spectra(number, shown)
    for name, swept in SWEEPS.items():
        yield name, sweep_picture(name, swept)
    yield "figure-H1", acoustic_responses()


def _simulated(shown: Runs, case: Case) -> Run:
    rig, fit, support = load_material_rig(shown.material), case.interference, case.support_stiffness
    damping = case.damping
    if damping is not None and math.isnan(damping):
        damping = critical_damping(
            rig, case.speed, interference=fit, support_stiffness=support, highest=0.1
        )
    return simulate(
        rig if damping is None else with_damping(rig, damping),
        case.speed,
        interference=fit,
        support_stiffness=support,
        seconds=shown.seconds,
        settling=0.0 if shown.from_rest else None,
    )


def torque_spectra(number: str, shown: Runs) -> Figure:
    """Draw autospectra of the recorded torque, a row per run."""
    with styled():
        figure = new_figure(1.0 + 2.0 * len(shown.cases), f"Figure {number}: {shown.material}")
        rows = figure.subplots(len(shown.cases), 1, sharex=True)
        for axes, case in zip(rows, shown.cases, strict=True):
            draw_spectrum(axes, _simulated(shown, case).recording, "torque")
            axes.set_title(str(case))
        rows[-1].set_xlabel("Frequency [Hz]")
    return figure


def sweep_picture(name: str, shown: Swept) -> Figure:
    """Draw mean torque and slip frequency over speed."""
    swept = sweep(
        rig_of(shown.material),
        np.geomspace(*shown.speeds, _STEPS),
        1e-3 * np.array(shown.fits)[:, np.newaxis, np.newaxis],
        np.array(shown.supports)[:, np.newaxis],
        settling=0.5,
    )
    with styled():
        figure = new_figure(7.0, f"{name}: {shown.material}, torque and slips over speed")
        for axes, feature in zip(
            figure.subplots(2, 1, sharex=True), ("torque_mean", "slip_frequency"), strict=True
        ):
            swept.plot(feature, axes)
            axes.set_ylim(bottom=0.0)
    return figure


def acoustic_responses() -> Figure:
    """Draw sound pressure per torque at the clamp, by support (Figure H1).

    Examples
    --------
    >>> [axes.get_title("left") for axes in acoustic_responses().axes]
    ['2214 Nm/rad', '3745 Nm/rad', 'clamp fixed']
    """
    rig = rig_of(CALIBRATED)
    with styled():
        figure = new_figure(9.0, "Figure H1: acoustic response of the modelled rig")
        for axes, support in zip(figure.subplots(3, 1), _SUPPORTS, strict=True):
            response = impulse_responses(rig, 0.279e-3, support, _RADIATION_RATE).torque_to_pressure
            frequency = rfftfreq(response.size, 1.0 / _RADIATION_RATE)
            shown = (frequency > _AUDIBLE[0]) & (frequency <= _AUDIBLE[1])
            TransferFunction(
                frequency[shown], rfft(response)[shown], None, "N m", "Pa", "torque to pressure"
            ).plot(axes)
            axes.set_title(support_words(support))
    return figure
