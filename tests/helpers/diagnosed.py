"""Answers for a folder as the blind check scores them, which shares no code with the program."""

from __future__ import annotations

from typing import TYPE_CHECKING

from noise.diagnosis.diagnose import diagnose
from noise.diagnosis.outcome import as_json
from noise.identification import outcome
from noise.identification.identify import identify

if TYPE_CHECKING:
    from pathlib import Path


def diagnosis_json(data: Path, rig: Path, *, quick: bool = False) -> dict:
    """Return the content of ``diagnosis.json`` for a folder."""
    return as_json(diagnose(data, rig, quick=quick))


def identification_json(data: Path, rig: Path) -> dict:
    """Return the content of ``identification.json`` for a folder."""
    return outcome.as_json(identify(data, rig))
