"""Panels of the thesis's figures: histories, orbits, spectra, torque over speed, static tests."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from features.kernels.spectra import autospectrum
from models.condition import FIXED
from models.drawing import BLUE, GREEN, VERMILION, levels, padded
from noise.pictures.figure import KINDS, support_words
from noise.pictures.panels import Curve, Panel
from noise.pictures.run import oscillates
from noise.pictures.thesis_runs import (
    COLOURS,
    DISPLACEMENT,
    FIRST_MODE,
    FITS,
    LINES,
    MEAN_TORQUE,
    MODELS,
    SHOWN,
    SLIDING,
    SUPPORTS,
    SWEPT,
    TORQUE,
    V_CRIT1,
    V_CRIT2,
    SweptTorque,
    Trace,
    exact_trace,
    listing_trace,
    recorded_trace,
    swept_torque,
    traces,
)
from noise.thesis.runs import (
    LONG,
    RATE,
    SHORT,
    THESIS,
    Case,
    listing_sudden_share,
    motion,
    rig_of,
)
from noise.thesis.stiffness import MEASURED
from sim.analysis.critical_damping import critical_damping, largest_sticking
from sim.analysis.slips import LEAST_SUDDEN

Grid = list[list[Panel]]

_TORQUE_SPAN, _WHOLE_SPAN = (0.0, 2e3), (20.0, 15e3)
"""Of the spectra of the torque alone, linear, and of all channels, logarithmic [Hz]."""

_STATIC_SPEED = 0.05
"""Of the shaft in a static test [rad/s]."""

_HIGHEST_DAMPING = 0.1
"""At which nothing sticks in Figure 6.10 [Nm s/rad]."""

FRICTION_TYPES = {
    "(a) stick-slip": Case(1.0, 0.279, FIXED),
    "(b) with feedback": Case(1.0, 0.279, SHORT),
    "(c) triangular": Case(4.3, 0.178, LONG),
    "(d) harmonic": Case(7.9, 0.279, SHORT),
}
"""Of Figures 5.1 and 5.2."""


def histories(
    shown: Sequence[Trace],
    quantities: Sequence[str] = (TORQUE, DISPLACEMENT, SLIDING),
    *,
    across: str = "Time [ms]",
    peak_speed: float | None = None,
) -> Grid:
    """Quantities over time, a row each, a column a model that gives them all.

    Parameters
    ----------
    shown : sequence of Trace
    quantities : sequence of str
        Keys of their values.
    across : str
        Of the axis of time.
    peak_speed : float, optional
        Largest sliding speed that the thesis names [rad/s].
    """
    known = [trace for trace in shown if set(quantities) <= set(trace.values)]
    grid = []
    for i, up in enumerate(quantities):
        row = []
        for trace in known:
            time = 1e3 * trace.time
            curves = [Curve(time, trace.values[up], "", COLOURS[trace.name])]
            if peak_speed is not None and up == SLIDING:
                ends = time[[0, -1]], [peak_speed, peak_speed]
                curves.append(Curve.published(*ends, f"largest {peak_speed:g} rad/s", "--"))
            row.append(Panel("" if i else trace.name, across, up, curves))
        grid.append(row)
    return grid


def orbits(shown: Sequence[Trace], across: str, up: str) -> Grid:
    """One quantity against another, a panel a model."""
    ends = np.concatenate([one.values[across] for one in shown])
    span = padded(float(ends.min()), float(ends.max()), 0.0)
    row = []
    for one in shown:
        curve = Curve(one.values[across], one.values[up], "", COLOURS[one.name])
        row.append(Panel(one.name, across, up, [curve], span=span))
    return [row]


def _modes(support: float) -> dict[str, float]:
    found = FIRST_MODE.get(support)
    return {} if found is None else {f"first torsional mode, {found:g} Hz": found}


def _spectrum(
    torques: Mapping[tuple[str, str], tuple[NDArray[np.float64], float]],
    title: str,
    marks: Mapping[str, float],
    kind: str = "torque",
    *,
    whole: bool = False,
) -> Panel:
    """Autospectra of signals and their rates [Hz], by their label and colour."""
    about = KINDS[kind]
    low, high = span = _WHOLE_SPAN if whole else _TORQUE_SPAN
    curves = []
    for (label, colour), (values, rate) in torques.items():
        found = autospectrum(values, rate)
        within = (found.frequency >= low) & (found.frequency <= high)
        level = levels(found.density[within], about.reference)
        curves.append(Curve(found.frequency[within], level, label, colour or about.colour))
    return Panel(
        title,
        "Frequency [Hz]",
        f"{about.name}\n[dB re {about.density}]",
        curves,
        marks,
        span=span,
        log_frequency=whole,
        most=90.0,
    )


def spectra(*columns: tuple[str, Sequence[tuple[str, Case]]]) -> Grid:
    """Autospectra of the settled torque in both models, by column and what its cases differ by.

    Examples
    --------
    >>> grid = spectra(("2214 Nm/rad", [("1 rad/s", Case(1.0)), ("12 rad/s", Case(12.0))]))
    >>> [panel.note for row in grid for panel in row]
    ['', 'steady sliding: constant torque, calibrated']
    """
    grid = []
    for title, cases in columns:
        panels = []
        for name, case in cases:
            torques, steady = {}, []
            for model, material in MODELS.items():
                torque = motion(material, case).torque
                torque = torque[torque.size // 4 :]
                if oscillates(torque):
                    torques[model, COLOURS[model]] = torque, RATE
                else:
                    steady.append(model)
            note = f"steady sliding: {', '.join(steady)}" if steady else ""
            panel = _spectrum(torques, f"{title}, {name}", _marks(case))
            panels.append(replace(panel, note=note))
        grid.append(panels)
    return [list(row) for row in zip(*grid, strict=True)]


def _marks(case: Case) -> dict[str, float]:
    return _modes(case.support_stiffness) | {f"{f:.4g} Hz": f for f in LINES.get(case, ())}


def channels(
    material: str,
    case: Case,
    names: tuple[str, ...] = ("torque",),
    marks: Mapping[str, float] | None = None,
    *,
    with_spectra: bool = True,
) -> Grid:
    """Record channels; show them over time and their autospectra, a row each.

    Parameters
    ----------
    material : str
    case : Case
    names : tuple of str
        Of the channels; the spectrum of the torque alone is shown as far as it reaches.
    marks : mapping of str to float, optional
        Frequencies that the thesis names beside `LINES` [Hz].
    with_spectra : bool

    Examples
    --------
    >>> (torque, spectrum), = channels("PDMS", Case(1.0, 0.381))
    >>> torque.up, list(spectrum.marks)
    ('Torque [Nm]', ['first torsional mode, 250 Hz'])
    """
    trace, grid = recorded_trace(material, case), []
    rate = 1.0 / float(trace.time[1])
    for i, name in enumerate(names):
        row = [_history(trace, name, f"({'abc'[i]}) {KINDS[name].name}")]
        if with_spectra:
            signal = {("", ""): (trace.values[name], rate)}
            title = f"({'abcdef'[i + len(names)]}) autospectrum"
            shown = _marks(case) | dict(marks or {})
            row.append(_spectrum(signal, title, shown, name, whole=len(names) > 1))
        grid.append(row)
    return grid


def _history(trace: Trace, name: str, title: str, colour: str = "") -> Panel:
    """Show a channel about the largest acceleration, as slips may be far apart."""
    kind = KINDS[name]
    peak = float(trace.time[np.abs(trace.values["acceleration"]).argmax()])
    start = min(max(0.0, peak - 0.25 * SHOWN), float(trace.time[-1]) - SHOWN)
    shown = trace.during(start, start + SHOWN)
    return Panel(
        title,
        "Time [ms]",
        f"{kind.name} [{kind.unit}]",
        [Curve(1e3 * shown.time, shown.values[name], "", colour or kind.colour)],
        span=(0.0, 1e3 * SHOWN),
        least=kind.least_swing,
        from_zero=name == "torque",
    )


def friction_types() -> Grid:
    """Torque over time of the four types, in two models."""
    return [
        [
            _history(recorded_trace(material, case), "torque", f"{name}: {case}; {model}", colour)
            for (model, material), colour in zip(MODELS.items(), (BLUE, VERMILION), strict=True)
        ]
        for name, case in FRICTION_TYPES.items()
    ]


def spectra_by_support(material: str, speed: float, fit: float) -> Grid:
    """Autospectra of the torque with both beams, by speed [rad/s] and interference fit [m]."""
    row = []
    for letter, support in (("(a)", LONG), ("(b)", SHORT)):
        trace = recorded_trace(material, Case(speed, fit, support))
        signal = {("", ""): (trace.values["torque"], 1.0 / float(trace.time[1]))}
        row.append(_spectrum(signal, f"{letter} {support_words(support)}", _modes(support)))
    return [row]


def _torques(swept: SweptTorque, model: str = "") -> list[Curve]:
    colour, lead = COLOURS.get(model, BLUE), f"{model}: " if model else ""
    return [
        Curve(swept.speed, swept.high, f"{lead}lowest to highest", colour, low=swept.low),
        Curve(swept.speed, swept.mean, f"{lead}mean torque", colour),
    ]


def _of_fit(fit: float, support: float, title: str) -> tuple[Panel, Panel]:
    """Torque and rate of its cycles over speed in both models, on a support."""
    torque, rate = [], []
    for model, material in MODELS.items():
        swept = swept_torque(material, fit, support)
        torque += _torques(swept, model)
        label = f"{model}: cycles a second"
        rate.append(Curve(swept.speed, swept.cycles, label, COLOURS[model], ".-"))
    torque.append(Curve.published([1.0, 13.0], 2 * [MEAN_TORQUE[fit]], "mean torque", ":"))
    if support in FIRST_MODE:
        ends = [0.0, SWEPT[-1]], 2 * [FIRST_MODE[support]]
        rate.append(Curve.published(*ends, "first torsional mode", ":"))
    for case, lines in LINES.items():
        if (case.interference_mm, case.support_stiffness) == (fit, support):
            rate.append(Curve.published(len(lines) * [case.speed], lines, "lines"))
    tables = {"end of oscillation": V_CRIT2, "end of stick": V_CRIT1}
    marks = {name: table[fit, support] for name, table in tables.items() if (fit, support) in table}
    across, span = "Speed of the shaft [rad/s]", (0.0, 1.03 * SWEPT[-1])
    return (
        Panel(title, across, "Torque [Nm]", torque, marks, span=span, from_zero=True),
        Panel("", across, "Frequency [Hz]", rate, marks, span=span, from_zero=True),
    )


def sweeps_of(fit: float) -> Grid:
    """Torque and rate of the slips over speed at a fit [mm], a column a support."""
    columns = [_of_fit(fit, support, support_words(support)) for support in SUPPORTS]
    return [list(row) for row in zip(*columns, strict=True)]


def torque_of_fits() -> Grid:
    """Torque over speed with the clamp fixed, a panel a fit."""
    titles = dict(zip(FITS, "abc", strict=True))
    return [[_of_fit(fit, FIXED, f"({titles[fit]}) {fit:g} mm")[0] for fit in FITS]]


def torque_over_speed(
    material: str,
    fit: float,
    fastest: Mapping[float, float],
    *,
    rise: float = 1.0,
    slowest: float = 1.0,
) -> Grid:
    """Mean, lowest and highest torque over speed, a panel a support.

    Parameters
    ----------
    material : str
    fit : float
        [mm]
    fastest : mapping of float to float
        Highest speed of the thesis [rad/s] by support [Nm/rad].
    rise : float
        Over the thesis's range, of the torque at its end over that at its beginning [-]. It is
        drawn from the first computed torque, as the thesis's levels are lost.
    slowest : float
        Where its range begins [rad/s].

    Examples
    --------
    >>> (panel,), = torque_over_speed("PDMS", 0.254, {2214.0: 17.0}, rise=3.0, slowest=0.25)
    >>> [curve.label for curve in panel.curves]
    ['lowest to highest', 'mean torque', 'thesis: 3 times, from our first torque on']
    """
    speeds = tuple(np.geomspace(slowest, max(fastest.values()), 25).tolist())
    row = []
    label = f"{'constant' if rise == 1.0 else f'{rise:g} times'}, from our first torque on"
    for letter, (support, last) in zip("ab", fastest.items(), strict=False):
        swept = swept_torque(material, fit, support, speeds)
        ends = [slowest, last], [swept.mean[0], rise * swept.mean[0]]
        curves = [*_torques(swept), Curve.published(*ends, label, "s--")]
        title, across = f"({letter}) {support_words(support)}", "Speed of the shaft [rad/s]"
        row.append(Panel(title, across, "Torque [Nm]", curves, from_zero=True))
    return [row]


def static_tests(fit: float) -> Grid:
    """Torque over the shaft's angle until it slips or slides, at a fit [mm], by support.

    Examples
    --------
    >>> [panel.title for panel in static_tests(0.279)[0]]
    ['2214 Nm/rad', '3745 Nm/rad', 'clamp fixed']
    """
    measured = {support: k_eff for support, (k_eff, _) in MEASURED[fit].items()}
    measured[FIXED] = rig_of(THESIS).fit(1e-3 * fit).elastomer_stiffness
    row = []
    for support, stiffness in measured.items():
        curves = []
        for trace in traces(Case(_STATIC_SPEED, fit, support), 2.0):
            torque = trace.values[TORQUE]
            slides = float(trace.time[(torque >= 0.99 * torque.max()).argmax()])  # where it creeps
            held = trace.during(0.0, min([slides, *trace.slips[:1]]))
            angle = 1e3 * _STATIC_SPEED * held.time
            curves.append(Curve(angle, held.values[TORQUE], trace.name, COLOURS[trace.name]))
        ends = np.array([0.0, max(float(curve.y.max()) for curve in curves)])
        label = f"regression {stiffness:g} Nm/rad"  # of Table 5.3; its points are lost
        curves.append(Curve.published(1e3 * ends / stiffness, ends, label, "--"))
        across = "Angle of the shaft [mrad]"
        row.append(Panel(support_words(support), across, "Torque [Nm]", curves, from_zero=True))
    return [row]


def by_damping(case: Case) -> Grid:
    """Phase planes of both models below, at and above their critical damping."""
    exact = critical_damping(
        rig_of(THESIS),
        case.speed,
        interference=case.interference,
        support_stiffness=case.support_stiffness,
        highest=_HIGHEST_DAMPING,
    )
    listing = largest_sticking(
        lambda c_e: listing_sudden_share(replace(case, damping=c_e), 1.0) > LEAST_SUDDEN,
        _HIGHEST_DAMPING,
        1e-5,
    )
    row = []
    for name, trace_of, critical in (
        ("listing", listing_trace, listing),
        ("equations, exact", exact_trace, exact),
    ):
        curves = []
        for words, c_e, colour, style in (
            ("0.05 Nm s/rad", 0.05, BLUE, "-"),
            ("critical", critical, GREEN, "--"),
            ("0.1 Nm s/rad", 0.1, VERMILION, "-"),
        ):
            trace = trace_of(replace(case, damping=c_e))
            first = float(trace.slips[0])
            values = trace.during(first - 2e-4, first + 2e-3).values
            x, y = values[DISPLACEMENT], values[SLIDING]
            curves.append(Curve(x, y, f"$c_E$: {words}", colour, style))
        title = f"{name}: critical {critical:.4f} Nm s/rad"
        row.append(Panel(title, DISPLACEMENT, SLIDING, curves))
    return [row]


def torque_and_spectrum(case: Case) -> Grid:
    """Settled torque over time, and its autospectrum; one row a model."""
    grid = []
    for trace in traces(case, 1.0):
        shown, torque = trace.settled(SHOWN), trace.values[TORQUE]
        colour, rate = COLOURS[trace.name], 1.0 / float(trace.time[1] - trace.time[0])
        curve = Curve(1e3 * shown.time, shown.values[TORQUE], "", colour)
        left = Panel(trace.name, "Time [ms]", TORQUE, [curve], span=(0.0, 1e3 * SHOWN))
        signal = {("", colour): (torque[torque.size // 4 :], rate)}
        grid.append([left, _spectrum(signal, "autospectrum", {})])
    return grid
