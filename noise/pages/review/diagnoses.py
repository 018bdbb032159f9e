"""A diagnosis read back from its folder, to stand in a review beside the sounds it explains.

What it says is in ``diagnosis.json``. What it lets hear, measured beside simulated, is in the
``report.html`` beside that.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from models.errors import RecordingError
from models.foreign_file import LARGEST_JSON, parse_json, reading
from noise.diagnosis.outcome_json import from_json
from noise.diagnosis.text.sentences import answer
from noise.diagnosis.text.verdict_sentences import headline
from noise.pages.diagnosis.sounds import reported_entries

if TYPE_CHECKING:
    from pathlib import Path

    from noise.pages.engine.entry import Entry

__all__ = ["DiagnosisDisplay", "read_diagnosis"]


class DiagnosisDisplay(NamedTuple):
    """What a review tells of a diagnosis.

    Parameters
    ----------
    name : str
        Of its folder.
    headline : str
    answer : list of str
        Verdict, location, and what the channels cannot tell apart.
    next_measurement : str
    notes : tuple of str
    entries : list of Entry
        Measured and simulated sounds, recording by recording.
    """

    name: str
    headline: str
    answer: list[str]
    next_measurement: str
    notes: tuple[str, ...]
    entries: list[Entry]


def read_diagnosis(path: Path) -> DiagnosisDisplay:
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
    with reading(path, "diagnosis", error=RecordingError, largest=LARGEST_JSON):
        data = parse_json(path.read_text(encoding="utf-8"))
        if not isinstance(data, dict) or "verdict" not in data or "probabilities" not in data:
            raise RecordingError(f"{path}: has no verdict and probabilities, so is no diagnosis")
        diagnosis = from_json(data)
        words = headline(diagnosis), answer(diagnosis)
    return DiagnosisDisplay(
        path.parent.resolve().name,
        *words,
        diagnosis.next_measurement,
        diagnosis.notes,
        reported_entries(path.with_name("report.html"), diagnosis),
    )
