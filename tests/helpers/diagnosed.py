"""Diagnosis of a folder as the blind check scores it, which shares no code with the program."""

from __future__ import annotations

from typing import TYPE_CHECKING

from noise.diagnosis.diagnose import diagnose
from noise.diagnosis.outcome import as_json

if TYPE_CHECKING:
    from pathlib import Path


def diagnosis_json(data: Path, rig: Path, *, quick: bool = False) -> dict:
    """Return the content of ``diagnosis.json`` for a folder."""
    return as_json(diagnose(data, rig, quick=quick))
