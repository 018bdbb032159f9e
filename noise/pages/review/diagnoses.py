"""A diagnosis read back from its folder, to stand in a review beside the sounds it explains.

What it says is in ``diagnosis.json``. What it lets hear, measured beside simulated, is in the
``report.html`` beside that, and is taken from there, so that a review plays the very sounds.
"""

from __future__ import annotations

import base64
import io
import json
import math
from dataclasses import dataclass
from html.parser import HTMLParser
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import soundfile

from models.condition import Condition
from models.errors import RecordingError
from noise.audio.sound import resampled
from noise.diagnosis.outcome import Diagnosis, EffectFinding, Location
from noise.diagnosis.text.sentences import (
    equivalence_sentences,
    headline,
    location_sentence,
    verdict_sentence,
)
from noise.pages.diagnosis.figures import CURVES
from noise.pages.review.entries import RATE, Entry

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

__all__ = ["ShownDiagnosis", "read_diagnosis"]

_REPORT = "report.html"


@dataclass(frozen=True)
class ShownDiagnosis:
    """What a review tells of a diagnosis.

    Parameters
    ----------
    name : str
        Of its folder.
    headline : str
    sentences : tuple of str
        Verdict, location, and what the channels cannot tell apart.
    next_measurement : str
    notes : tuple of str
    entries : tuple of Entry
        Measured and simulated sounds, recording by recording.
    """

    name: str
    headline: str
    sentences: tuple[str, ...]
    next_measurement: str
    notes: tuple[str, ...]
    entries: tuple[Entry, ...]


def read_diagnosis(path: Path) -> ShownDiagnosis:
    """Read a diagnosis.

    Parameters
    ----------
    path : Path
        Its ``diagnosis.json``.

    Raises
    ------
    RecordingError
        It cannot be read, or is no diagnosis.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> from noise.pages.diagnosis.page import write_diagnosis
    >>> nothing = Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0)
    >>> with tempfile.TemporaryDirectory() as name:
    ...     write_diagnosis(Path(name), nothing)
    ...     read_diagnosis(Path(name) / "diagnosis.json").headline
    'No gap'
    """
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read ({error.strerror or error})") from None
    except ValueError as error:
        raise RecordingError(f"{path}: is damaged or no JSON ({error})") from None
    if not isinstance(data, dict) or "verdict" not in data or "probabilities" not in data:
        raise RecordingError(f"{path}: has no verdict and probabilities, so is no diagnosis")
    try:
        diagnosis = _diagnosis(data)
        sentences = (
            verdict_sentence(diagnosis),
            location_sentence(diagnosis),
            *equivalence_sentences(diagnosis),
        )
        told = headline(diagnosis)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise RecordingError(f"{path}: is damaged ({type(error).__name__}: {error})") from None
    return ShownDiagnosis(
        path.parent.resolve().name,
        told,
        tuple(filter(None, sentences)),
        diagnosis.next_measurement,
        diagnosis.notes,
        _entries(path.with_name(_REPORT), data),
    )


def _diagnosis(data: Mapping[str, Any]) -> Diagnosis:
    place = data["location"]
    location = None
    if place is not None:
        low, high = map(_number, place["band_hz"])
        location = Location(
            place["stage"], tuple(place["channels"]), (low, high), place["phase"],
            place["conditions"], _number(place["p_value"]),
        )  # fmt: skip
    return Diagnosis(
        verdict=tuple(data["verdict"]),
        equivalent=tuple((one, other) for one, other in data["equivalent"]),
        location=location,
        stages={},
        effects=tuple(
            EffectFinding(each["name"], each["stage"], _number(each["probability"]))
            for each in data["effects"]
        ),
        probabilities={name: _number(p) for name, p in data["probabilities"].items()},
        parameters={
            name: (_number(low), _number(high)) for name, (low, high) in data["parameters"].items()
        },
        next_measurement=str(data.get("next_measurement") or ""),
        held_out=tuple(data.get("held_out") or ()),
        gap=_number(data.get("gap")),
        floor=_number(data.get("gap_floor")),
        p_value=_number(data.get("p_value")),
        seconds=_number(data.get("seconds")),
        notes=tuple(map(str, data.get("notes") or ())),
    )


def _number(value: object) -> float:
    return float(cast("float", value)) if value is not None else math.nan


def _entries(report: Path, data: Mapping[str, Any]) -> tuple[Entry, ...]:
    """Sounds of the report; none where there is no report, or it holds none."""
    try:
        text = report.read_text(encoding="utf-8")
    except (OSError, ValueError):
        return ()
    players = _Players()
    players.feed(text)
    heard = {one["recording"]: one for one in data.get("heard") or ()}
    return tuple(_entry(found, heard.get(found["data-recording"], {})) for found in players.found)


class _Players(HTMLParser):
    """Collects the players of a report."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[dict[str, str]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Keep a player that says what it plays."""
        values = {name: value or "" for name, value in attrs}
        if tag == "audio" and {"data-recording", "data-role", "data-pascal", "src"} <= set(values):
            self.found.append(values)


def _entry(player: Mapping[str, str], heard: Mapping[str, Any]) -> Entry:
    name, role = player["data-recording"], player["data-role"]
    try:
        content = base64.b64decode(player["src"].partition("base64,")[2])
        fractions, rate = soundfile.read(io.BytesIO(content), always_2d=True)
        sound = resampled(fractions[:, 0] * float(player["data-pascal"]), rate, RATE)
    except (ValueError, soundfile.LibsndfileError) as error:
        raise RecordingError(f"sound {name} of the report is damaged ({error})") from None
    rows: tuple[dict[str, object], ...] = ()
    note = "from the report of the diagnosis"
    if label := heard.get("label", {}).get(role):
        rows = ({"label": label},)
        level = heard.get("level_dba", {}).get(role)
        note += "" if level is None else f"; {level:.1f} dB(A)"
    title = f"{name}, {CURVES[role].label if role in CURVES else role}"
    return Entry(
        title, rows, Condition(), "diagnosis", sound.size / RATE, sound.astype(np.float32), 0.0,
        calibrated=True, note=note,
    )  # fmt: skip
