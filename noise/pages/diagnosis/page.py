"""The report of a diagnosis: one page to be understood in a minute, and its data beside it.

Order is rank: what is missing and how sure that is, where it acts, how far it closes the gap, what
to measure next; then the evidence for eye and ear; figures for whoever doubts come last. As the
review page, it holds everything it shows and forbids the browser to fetch anything.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from noise.base.atomic import atomic
from noise.diagnosis.outcome import as_json
from noise.diagnosis.text.sentences import (
    equivalence_sentences,
    headline,
    location_sentence,
    verdict_sentence,
)
from noise.diagnosis.text.words import p_number
from noise.pages.diagnosis.contact_figures import contact_panels
from noise.pages.diagnosis.figures import CURVES, illustration_panels
from noise.pages.diagnosis.sounds import played_sounds
from noise.pages.diagnosis.view import (
    NOT_DETERMINED,
    cause_rows,
    number,
    parameter_rows,
    place_rows,
    stage_boxes,
)
from noise.pages.diagnosis.waterfall import waterfall
from noise.pages.templating import template

if TYPE_CHECKING:
    from pathlib import Path

    from models.condition import Condition
    from noise.diagnosis.outcome import Diagnosis, Heard, Illustration
    from noise.pages.figures import Panel

__all__ = ["write_diagnosis"]


@dataclass(frozen=True)
class _Player:
    role: str
    label: str
    heard: str
    uri: str


@dataclass(frozen=True)
class _Shown:
    name: str
    condition: str
    roles: tuple[str, ...]
    players: tuple[_Player, ...]
    panels: tuple[Panel, ...]


def write_diagnosis(folder: Path, diagnosis: Diagnosis) -> None:
    """Write ``report.html`` and ``diagnosis.json``, both whole or none at all.

    Parameters
    ----------
    folder : Path
        Made where it is not there; older files of these names are replaced.
    diagnosis : Diagnosis

    Raises
    ------
    ParameterError
        A file cannot be written, or a signal cannot be analysed.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> nothing = Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0)
    >>> with tempfile.TemporaryDirectory() as name:
    ...     write_diagnosis(Path(name), nothing)
    ...     sorted(path.name for path in Path(name).iterdir())
    ['diagnosis.json', 'report.html']
    """
    data = json.dumps(as_json(diagnosis), indent=2, ensure_ascii=False, allow_nan=False)
    html = _html(diagnosis)
    with atomic(folder / "diagnosis.json") as json_part, atomic(folder / "report.html") as page:
        # Names of files may hold what no UTF-8 can.
        json_part.write_bytes(f"{data}\n".encode("utf-8", "backslashreplace"))
        page.write_bytes(html.encode("utf-8", "backslashreplace"))


def _html(diagnosis: Diagnosis) -> str:
    sounds = played_sounds(diagnosis.illustrations)
    shown = [
        _shown(illustration, uris, diagnosis.heard)
        for illustration, uris in zip(diagnosis.illustrations, sounds.uris, strict=True)
    ]
    likely, unlikely = cause_rows(diagnosis)
    return template("diagnosis.html.j2").render(
        headline=headline(diagnosis),
        verdict=verdict_sentence(diagnosis),
        location=location_sentence(diagnosis),
        equivalent=equivalence_sentences(diagnosis),
        stages=stage_boxes(diagnosis),
        waterfall=waterfall(diagnosis),
        likely=likely,
        unlikely=unlikely,
        next_measurement=diagnosis.next_measurement,
        notes=diagnosis.notes,
        shown=shown,
        curves=CURVES,
        gain=sounds.words,
        full_scale=sounds.full_scale,
        places=place_rows(diagnosis.differences),
        parameters=parameter_rows(diagnosis.parameters),
        held_out=diagnosis.held_out,
        heard=[_heard_row(heard) for heard in diagnosis.heard],
        gap=number(diagnosis.gap),
        floor=number(diagnosis.floor),
        p_value=p_number(diagnosis.p_value),
        seconds=number(diagnosis.seconds, ".1f"),
        not_determined=NOT_DETERMINED,
        judged=bool(diagnosis.verdict),
    )


def _shown(illustration: Illustration, uris: dict[str, str], heard: tuple[Heard, ...]) -> _Shown:
    roles = ("measured", "before") if illustration.after is None else tuple(CURVES)
    known = next((one for one in heard if one.recording == illustration.name), None)
    players = tuple(
        _Player(
            role,
            CURVES[role].label,
            "" if known is None else _label_and_level(*_of_role(known, role)),
            uris[role],
        )
        for role in roles
        if role in uris
    )
    panels = (*illustration_panels(illustration), *contact_panels(illustration.contacts))
    condition = _condition(illustration.measured.condition)
    return _Shown(illustration.name, condition, roles, players, panels)


def _of_role(heard: Heard, role: str) -> tuple[str | None, float | None]:
    return {
        "measured": (heard.label_measured, heard.level_measured),
        "before": (heard.label_before, heard.level_before),
        "after": (heard.label_after, heard.level_after),
    }[role]


def _label_and_level(label: str | None, level: float | None) -> str:
    if label is None and level is None:
        return NOT_DETERMINED
    known = level is not None and math.isfinite(level)
    words = [label or "label not determined"]
    words.append(f"{number(level, '.1f')} dB(A)" if known else "level not determined")
    return ", ".join(words)


def _heard_row(heard: Heard) -> tuple[str, list[tuple[str, str]]]:
    return heard.recording, [
        (curve.label, _label_and_level(*_of_role(heard, role))) for role, curve in CURVES.items()
    ]


def _condition(condition: Condition) -> str:
    known = []
    if condition.speed is not None:
        known.append(f"{number(condition.speed, '.4g')} rad/s")
    if condition.interference is not None:
        known.append(f"{1e3 * condition.interference:.4g} mm")
    if condition.support_stiffness is not None:
        fixed = math.isinf(condition.support_stiffness)
        known.append("clamp fixed" if fixed else f"{condition.support_stiffness:.5g} Nm/rad")
    if condition.temperature is not None:
        known.append(f"{number(condition.temperature, '.3g')} °C")
    return ", ".join(known)
