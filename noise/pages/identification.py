"""Report of an identification: numbers, friction law, and pictures of each step."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from models.drawing import BLUE, GREY, VERMILION, styled
from noise.base.files import atomic
from noise.base.progress import counted
from noise.identification.law_model import CANDIDATES
from noise.identification.outcome import Forecast, Identification, Number, RecordingFit, as_json
from noise.pages import blocks as b
from noise.pages.figures import Line, Panel, cycle_window, lines_panel
from noise.pages.page import page_html, write_page

_SHOWN = 0.03
"""Length of the part of a recording that is drawn [s]."""


def recording_panels(one: RecordingFit) -> tuple[Panel, ...]:
    """Draw torque over angle of a recording, and the prediction of the law.

    Parameters
    ----------
    one : RecordingFit

    Returns
    -------
    tuple of Panel
    """
    with styled():
        panels = (_rise(one),)
        return panels if one.forecast is None else (*panels, _prediction(one.forecast))


def _rise(one: RecordingFit) -> Panel:
    """Draw torque over angle, with the slope of elastomer and support in series."""
    spectrum, fit = one.fit.spectrum, one.fit
    begin = round(cycle_window(spectrum.torque, spectrum.rate, _SHOWN)[0] * spectrum.rate)
    end = begin + round(_SHOWN * spectrum.rate)
    angle = np.cumsum(spectrum.shaft_speed[begin:end]) / spectrum.rate
    angle -= angle[0]
    torque, stuck = spectrum.torque[begin:end], fit.phases.stuck[begin:end]
    bushing = fit.bushing
    stiffness = 1.0 / (1.0 / bushing.elastomer_stiffness + 1.0 / bushing.support_stiffness)
    first = int(np.argmin(torque))
    rise = torque[first] + (angle - angle[first]) * stiffness
    inside = (rise <= torque.max()) & (angle >= angle[first])
    return lines_panel(
        "Torque over the shaft's angle", "Angle [mrad]", "Torque [Nm]",
        [
            Line(1e3 * angle, torque, GREY, "slips"),
            Line(1e3 * angle, np.where(stuck, torque, np.nan), BLUE, "sticks", 2.0),
            Line(1e3 * angle[inside], rise[inside], VERMILION,
                 f"rise by {stiffness:.4g} Nm/rad", style="--"),
        ],
        f"Torque over angle: rises by {stiffness:.4g} Nm/rad while the contact sticks.",
        legend="upper left", room=(0.0, 0.55),
    )  # fmt: skip


def _prediction(forecast: Forecast) -> Panel:
    """Draw the recorded and the predicted torque of an excerpt."""
    time = 1e3 * np.arange(forecast.recorded.size) / forecast.rate
    missed = float(np.std(forecast.predicted - forecast.recorded) / np.std(forecast.recorded))
    return lines_panel(
        "What the law predicts of a cycle", "Time [ms]", "Torque [Nm]",
        [
            Line(time, forecast.recorded, GREY, "recorded", 2.5),
            Line(time, forecast.predicted, VERMILION, "predicted", 1.0),
        ],
        f"Recorded and predicted torque; {100.0 * missed:.1f} % is missed.",
        legend="lower right", room=(0.25, 0.0),
    )  # fmt: skip


_CANDIDATES = {candidate.name: candidate for candidate in CANDIDATES}

_MEANINGS = {
    "critical_torque": (
        "recorded peak torque", "median of the highest torque of each cycle; critical_torque"
    ),
    "kinetic_torque": (
        "recorded sliding torque", "mean while the contact slides fast; kinetic_torque"
    ),
    "law_critical_torque": (
        "critical torque", "of the law that fits best: critical_torque_Nm of the rig file"
    ),
    "law_kinetic_torque": (
        "kinetic torque", "of the law that fits best: kinetic_torque_Nm of the rig file"
    ),
    "elastomer_damping_share": (
        "elastomer damping share", "of the damping, what acts in the elastomer, not in the beams"
    ),
}  # fmt: skip
"""Names and descriptions of numbers whose key says too little, with the key of the JSON file."""


def write_identification(folder: Path, result: Identification) -> None:
    """Write ``rig.toml``, ``identification.json`` and ``report.html``, all whole or none.

    Parameters
    ----------
    folder : Path
        Created if missing; older files of these names are replaced.
    result : Identification

    Raises
    ------
    ParameterError
        A file cannot be written.
    """
    data = json.dumps(as_json(result), indent=2, ensure_ascii=False, allow_nan=False)
    html = _html(result)
    with atomic(folder / "rig.toml") as rig, atomic(folder / "identification.json") as path:
        rig.write_text(result.rig_toml, encoding="utf-8")
        # Names of files may hold what no UTF-8 can.
        path.write_bytes(f"{data}\n".encode("utf-8", "backslashreplace"))
        write_page(folder / "report.html", html)


def _html(result: Identification) -> str:
    slipping = [one for one in result.recordings if one.levels.slips]
    answer, *further = _answer(result)
    most = max([one.missed for one in result.laws], default=0.0) or 1.0
    laws: list[list[b.Cell | str]] = [
        [
            one.law.replace("_", " "), _CANDIDATES[one.law].words,
            b.Cell(
                f"{100.0 * one.missed:.1f}",
                bars=[b.Bar(0.0, 100.0 * one.missed / most, "cause" * (one.law == result.law))],
            ),
            f"{100.0 * one.held_out:.1f}", f"{100.0 * one.trained:.1f}",
            _CANDIDATES[one.law].in_rig_file,
        ]
        for one in result.laws
    ]  # fmt: skip
    choice = (
        f"Held out: {', '.join(result.held_out) or 'none'}. Missed is the share of the oscillation "
        "that a law, begun where a recording shows a slip, does not predict over the next cycle. "
        "Of the laws the simplest is chosen that misses little more than the best: up to "
        f"{100.0 * (result.margin - 1.0):.0f} % more for each parameter that it saves."
    )
    numbers = list(map(_row, result.numbers))
    lists = {
        "Assumed": result.assumed,
        "Not determined": result.not_found,
        "To know": result.notes,
        "Left out": [f"{name}: {reason}" for name, reason in result.refused],
    }
    columns = (
        "Law", "Meaning", "Missed [%]", "Held out [%]", "Fitted to [%]", "In the rig file"
    )  # fmt: skip
    return page_html(
        "diagnosis",
        _title(result),
        [b.Text(answer, "verdict"), *(b.Text(sentence, "where") for sentence in further)],
        [
            b.Section(
                "Numbers, with 90 % intervals",
                [b.Table(("Number", "At", "Value", "Interval", "Recordings"), numbers)],
            ),
            b.Section(
                "Law of friction",
                [
                    b.Table(columns, laws),
                    b.Text(choice if laws else "", "soft"),
                ],
            ),
            b.Section(
                "What each recording shows",
                [
                    b.Text(_RISE if slipping else "", "soft"),
                    *(
                        b.Group(
                            one.measured.name, [b.Panels(recording_panels(one))], _condition(one)
                        )
                        for one in slipping
                    ),
                ],
            ),
            b.Section(
                "Assumed, and not determined",
                [b.Group(heading, [b.Items(items)]) for heading, items in lists.items()],
            ),
            b.Section("The rig file", [b.Pre(result.rig_toml)]),
        ],
        footer=f"Identified in {result.seconds:.0f} s.",
        tab=f"Identification: {_title(result)}",
    )


_RISE = (
    "While the contact sticks, the torque rises, on average, as steeply as the dashed line, whose "
    "slope is the stiffness of elastomer and support in series. The line begins at the lowest "
    "torque of the picture, so compare its slope, not its height."
)


def _title(result: Identification) -> str:
    return f"The rig, identified from {counted(len(result.recordings), 'recording')}"


def _answer(result: Identification) -> list[str]:
    stiffness = [
        f"At {1e3 * (one.interference or 0.0):g} mm the stiffness of the elastomer is "
        f"{one.value:.4g} Nm/rad ({one.low:.4g} to {one.high:.4g})."
        for one in result.numbers
        if one.name == "elastomer_stiffness"
    ]
    chosen = next(score for score in result.laws if score.law == result.law)
    chosen_law = _CANDIDATES[result.law]
    return [
        f"Law of friction: {result.law.replace('_', ' ')} ({chosen_law.words}; "
        f"{chosen_law.in_rig_file} in the rig file). Within a cycle it leaves "
        f"{100.0 * chosen.missed:.1f} % of the oscillation unexplained"
        + (
            f", and {100.0 * chosen.held_out:.1f} % of that of recordings that its fit did not use."
            if result.held_out
            else "; no recording was held out."
        ),
        *stiffness,
    ]


def _row(one: Number) -> list[b.Cell | str]:
    at = []
    if one.interference is not None:
        at.append(f"{1e3 * one.interference:g} mm")
    if one.support_stiffness is not None:
        fixed = one.support_stiffness == float("inf")
        at.append("clamp fixed" if fixed else f"{one.support_stiffness:g} Nm/rad")
    return [
        b.Cell(*_MEANINGS.get(one.name, (one.name.replace("_", " "),))), ", ".join(at),
        f"{one.value:.4g} {one.unit}".rstrip(),
        f"{one.low:.4g} to {one.high:.4g}", str(one.n_recordings),
    ]  # fmt: skip


def _condition(one: RecordingFit) -> str:
    condition = one.measured.condition
    return ", ".join(replace(condition, speed=float(f"{condition.speed:.3g}")).words)
