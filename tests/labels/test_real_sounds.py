"""Recordings that nobody simulated; skipped where they are not at hand."""

import csv
import os
from pathlib import Path

import pytest

from noise.cli import main

DATA = os.environ.get("BUSHING_NOISE_REAL_DATA")


@pytest.mark.skipif(not DATA, reason="BUSHING_NOISE_REAL_DATA names no folder of real recordings")
def test_every_real_sound_is_labelled(tmp_path):
    folder = Path(DATA) / "audio"
    table = tmp_path / "labels.csv"
    assert main(["label", str(folder), "--out", str(table)]) == 0
    with table.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    sounds = {path.relative_to(folder).as_posix() for path in folder.rglob("*.flac")}
    assert {row["file"] for row in rows} == sounds
    assert not any(row["error"] for row in rows)
