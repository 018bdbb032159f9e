"""Recordings of a review, each cut to a stretch and labelled, and those that only a table names.

What is read is cut at once: a campaign may be larger than memory.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from models.errors import BushingNoiseError
from noise.audio.sound import LOWEST_HEARD, audible
from noise.base.progress import track
from noise.classifier import load_classifier
from noise.labels.labelling import label_rows
from noise.labels.segments import label_recording
from noise.pages.engine.clips import BYTES_A_SECOND, SHORTEST
from noise.pages.engine.entry import RATE, Entry, stretch_start
from noise.pages.review.inputs import Refusal, told_apart
from noise.pictures.recorded import recorded_levels, recorded_orders
from noise.recordings import read_recording
from noise.recordings.blocks import RecordingBlocks, open_blocks
from noise.recordings.folders import is_file

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from features.kernels.orders import OrderMap
    from models.recording import Recording
    from noise.classifier import Classifier
    from noise.pages.engine.entry import FastLevels, Row
    from noise.pages.review.inputs import Inputs, LabelTable
    from noise.recordings.meaning import PascalPerFullScale

__all__ = ["recorded_entries"]

_RUN_UP = 60.0
"""Longest stretch of a recording whose orders are told [s]."""

_GENEROUS = 4.0
"""Quiet sounds take a quarter of the space of loud noise."""


def recorded_entries(
    inputs: Inputs,
    refused: list[Refusal],
    *,
    seconds: float,
    full_scale: PascalPerFullScale | None,
    budget: float,
    classify: bool,
) -> list[Entry]:
    """Read recordings, and what tables say of those that are not at hand.

    Parameters
    ----------
    inputs : Inputs
    refused : list of Refusal
        Takes what cannot be read.
    seconds : float
        Longest stretch of a recording that is kept [s].
    full_scale : float or tuple of float, optional
        As for `noise.recordings.read_recording` [Pa].
    budget : float
        Of the page [byte].
    classify : bool
        Whether recordings that no table labels are labelled by the classifier that is shipped.
    """
    if not inputs.recordings and not inputs.tables:
        return []
    files = list(inputs.recordings)
    known = {path.resolve() for path, _ in files}
    named = _named_by_tables(inputs.tables, [path for path, _ in files])
    new = [found for found in named if found[0].resolve() not in known]
    files = list(told_apart([*files, *new]))
    needs = classify and any(not _labelled(path, inputs.tables) for path, _ in files)
    classifier = load_classifier() if needs else None
    # What could never fit is not read at all.
    longest = min(
        seconds, max(SHORTEST, _GENEROUS * budget / (BYTES_A_SECOND * max(1, len(files))))
    )
    entries: list[Entry] = []
    for path, name in track(files, "reading"):
        found = _read_entry(
            path, name, inputs.tables, classifier, longest=longest, full_scale=full_scale
        )
        if isinstance(found, Refusal):
            refused.append(found)
        else:
            entries.append(found)
    return entries + _missing(inputs.tables, [path for path, _ in files])


def _labelled(path: Path, tables: Sequence[LabelTable]) -> bool:
    return any(row["label"] is not None for table in tables for row in table.of(path))


def _named_by_tables(tables: Sequence[LabelTable], given: Sequence[Path]) -> list[tuple[Path, str]]:
    """Find recordings that a table names beside or below its own folder, and that are not given."""
    found: dict[Path, tuple[Path, str]] = {}
    for table in tables:
        there = _files_of(table, given)
        for name in dict.fromkeys(str(row["file"]) for row in table.rows):
            if name in there:
                continue
            for path in (table.path.parent / name, *_below(table.path.parent, name)):
                if is_file(path):
                    found.setdefault(path.resolve(), (path, name))
                    break
    return list(found.values())


def _files_of(table: LabelTable, recordings: Sequence[Path]) -> set[str]:
    """Return what a table calls the recordings that it has rows for."""
    return {str(row["file"]) for path in recordings for row in table.of(path)}


def _below(folder: Path, name: str) -> list[Path]:
    try:
        return sorted(folder.glob(f"*/{name}"), key=lambda path: path.parent.name != "recordings")
    except (ValueError, NotImplementedError):  # an absolute name, or one that is no pattern
        return []


def _missing(tables: Sequence[LabelTable], files: Sequence[Path]) -> list[Entry]:
    entries = []
    for table in tables:
        used = _files_of(table, files)
        for name in dict.fromkeys(str(row["file"]) for row in table.rows):
            rows = [row for row in table.rows if row["file"] == name and row["label"] is not None]
            if name not in used and rows:
                ends = (row.get("end_s") for row in rows)
                duration = max((end for end in ends if isinstance(end, int | float)), default=0.0)
                note = "labelled by the table; the recording is not at hand"
                entries.append(
                    Entry(name, tuple(rows), duration=duration, calibrated=False, note=note)
                )
    return entries


def _read_entry(
    path: Path,
    name: str,
    tables: Sequence[LabelTable],
    classifier: Classifier | None,
    *,
    longest: float,
    full_scale: PascalPerFullScale | None = None,
) -> Entry | Refusal:
    """Read what a review shows of a recording.

    Parameters
    ----------
    path : Path
    name : str
        What it is called.
    tables : sequence of LabelTable
        The first that has rows for it labels it.
    classifier : Classifier or None
        Labels what no table does; None leaves it without a label.
    longest : float
        Of the stretch that is kept [s].
    full_scale : float or tuple of float, optional
        As for `noise.recordings.read_recording`.
    """
    try:
        rows = next(filter(None, (table.of(path) for table in tables)), ())
        with open_blocks(path, full_scale=full_scale) as opened:
            blocks = opened or RecordingBlocks.of(read_recording(path, full_scale=full_scale))
            note = ""
            if any(row["label"] is not None for row in rows):
                note = "labelled by the table"
            elif classifier is not None:
                note = "labelled for this page"
                rows = tuple(label_rows(name, blocks, label_recording(blocks, classifier)))
            duration = blocks.n_samples / blocks.rate
            offset = stretch_start(rows, duration, longest)
            heard, why = _heard(blocks, offset, longest)
            sound, levels = (None, None) if heard is None else _sound(heard)
            orders = _orders(blocks, rows, duration)
    except BushingNoiseError as error:
        return Refusal.of(path, error)
    except OSError as error:  # it was there when the folder was searched
        return Refusal.of(path, f"cannot be read ({error.strerror or error})")
    return Entry(
        name, tuple(rows), blocks.condition, duration, sound, offset,
        blocks.calibrated, "; ".join(filter(None, (note, why))), orders,
        None if levels is None else (offset + levels[0], levels[1]),
    )  # fmt: skip


def _orders(blocks: RecordingBlocks, rows: Sequence[Row], duration: float) -> OrderMap | None:
    if blocks.first("pressure") is None or blocks.first("speed") is blocks.first("angle") is None:
        return None
    first = round(stretch_start(rows, duration, _RUN_UP) * blocks.rate)
    return recorded_orders(blocks.part(first, first + round(_RUN_UP * blocks.rate)))


def _heard(blocks: RecordingBlocks, offset: float, longest: float) -> tuple[Recording | None, str]:
    """Cut out what is heard; None, and why, where nothing is."""
    row = blocks.first("pressure")
    if row is None:
        return None, "no sound pressure to be heard"
    if blocks.rate < LOWEST_HEARD:
        return None, f"sampled at {blocks.rate:g} Hz, so nothing can be heard"
    first = round(offset * blocks.rate)
    last = min(blocks.n_samples, first + round(longest * blocks.rate))
    others = sum(channel.kind == "pressure" for channel in blocks.channels) - 1
    heard = blocks.track(row).cut(first, last)
    return heard, f"1 of {others + 1} channels is heard" if others else ""


def _sound(heard: Recording) -> tuple[NDArray[np.float32], FastLevels]:
    """Return the sound at the page's rate, and its level over time as the recording has it."""
    return audible(heard, RATE).astype(np.float32), recorded_levels(heard)
