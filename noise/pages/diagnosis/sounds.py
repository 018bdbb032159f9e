"""Sounds of a diagnosis: measured, before and after, at one gain for the whole page.

What a missing effect does to loudness is part of what it does; so nothing is matched, and the one
full scale is what the loudest of all sounds needs.
"""

from __future__ import annotations

import base64
import io
import math
from dataclasses import replace
from html.parser import HTMLParser
from typing import TYPE_CHECKING

import numpy as np
import soundfile

from models.errors import ParameterError, RecordingError
from models.foreign_file import LARGEST_JSON, reading, refusing
from models.recording import Channel
from noise.audio.sound import audible
from noise.diagnosis.findings import ROLES
from noise.diagnosis.text.words import number
from noise.pages.diagnosis.figures import CURVES
from noise.pages.engine.entry import RATE, Entry
from noise.pictures.recorded import recorded_levels, recorded_orders
from noise.recordings.meaning import check_finite

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from noise.diagnosis.findings import Illustration, LabelsAndLevels
    from noise.diagnosis.outcome import Diagnosis

__all__ = ["LONGEST", "illustration_entries", "reported_entries"]

LONGEST = 4.0
"""Of a sound on the page [s]; what is longer is played from its beginning."""

_NEEDED = {"data-recording", "data-role", "data-full-scale"}


def illustration_entries(
    illustration: Illustration, heard: Sequence[LabelsAndLevels] = ()
) -> dict[str, Entry]:
    """Return what is heard of an illustration, by role.

    Parameters
    ----------
    illustration : Illustration
    heard : sequence of LabelsAndLevels
        Labels and levels, of any recordings.

    Returns
    -------
    dict of str to Entry
        Keys are ``measured``, ``before`` and ``after``, where there is a sound.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> from noise.diagnosis.findings import Illustration
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
            sound = audible(recording, RATE)[: round(LONGEST * RATE)].astype(np.float32)
            entries[role] = replace(
                _entry(illustration.name, role, sound, heard),
                orders=recorded_orders(recording),
                fast_levels=recorded_levels(recording),
            )
    return entries


def reported_entries(report: Path, diagnosis: Diagnosis) -> list[Entry]:
    """Take the sounds out of the report of a diagnosis, so that a review plays the very sounds.

    Parameters
    ----------
    report : Path
        None are found where it is not there, or holds none.
    diagnosis : Diagnosis
        Has the labels and the levels.

    Raises
    ------
    RecordingError
        A sound is damaged.
    """
    try:
        with reading(report, "report", largest=LARGEST_JSON):
            found = _Sounds()
            found.feed(report.read_text(encoding="utf-8"))
    except ParameterError:
        return []
    entries = []
    for values, content in found.found:
        name, role = values["data-recording"], values["data-role"]
        with refusing(f"{report}: {name}", "sound", RecordingError):
            flac = io.BytesIO(base64.b64decode(content))
            fractions, _ = soundfile.read(flac, dtype="float32")
            with np.errstate(over="ignore", invalid="ignore"):  # refused in the next line
                sound = np.float32(values["data-full-scale"]) * fractions
            check_finite(report, sound[np.newaxis], RATE, (Channel("pressure"),))
        note = "from the report of the diagnosis"
        entries.append(_entry(name, role, sound, diagnosis.labels_and_levels, note))
    return entries


class _Sounds(HTMLParser):
    """Collects the sounds of a report, each with its attributes."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[tuple[dict[str, str], str]] = []
        self._open: dict[str, str] | None = None

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Keep the attributes of a sound that says what it is."""
        values = {name: value or "" for name, value in attrs}
        self._open = values if tag == "script" and set(values) >= _NEEDED else None

    def handle_data(self, data: str) -> None:
        """Keep the sound."""
        if self._open is not None:
            self.found.append((self._open, data))
            self._open = None


def _entry(
    name: str,
    role: str,
    sound: NDArray[np.float32],
    heard: Sequence[LabelsAndLevels],
    note: str = "",
) -> Entry:
    known = next((one for one in heard if one.recording == name), None)
    label, level = (None, None) if known is None else known.of(role)
    notes = [note] if note else []
    if level is not None and math.isfinite(level):
        notes.append(f"{number(level, '.1f')} dB(A)")
    elif known is not None:
        notes.append("level not determined")
    return Entry(
        f"{name}, {CURVES[role].label if role in CURVES else role}",
        () if label is None else ({"label": label},),
        duration=sound.size / RATE,
        sound=sound,
        note="; ".join(notes),
        data={"recording": name, "role": role},
    )
