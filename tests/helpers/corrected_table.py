"""A table that is corrected as the app does it, and what is in it then."""

from __future__ import annotations

from noise.app.labels import Labels
from noise.batch.work import find_jobs
from noise.labels.corrections import version
from noise.labels.table import read_label_table

NAMES = ("a.wav", "b.wav", "c.wav")


def labels_of(folder):
    return Labels(find_jobs([folder]), folder / "labels.csv")


def correct(labels, index, said):
    """Say it of what is shown now."""
    return labels.correct(index, said, version(labels.rows(index)))


def in_table(folder):
    rows = read_label_table(folder / "labels.csv")
    return [(r["file"], r["start_s"], r["end_s"], r["label"], r["label_source"]) for r in rows]
