"""Labelled recordings of the user, as training samples.

Labels come from the rows of a label table of ``bushing-noise label``, or from the names of folders
(``creak/run07.wav``). Of a table with corrections (`label_source` is ``human``), only the
corrections are used. Unusable files and labels are skipped, each with one line of explanation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.errors import BushingNoiseError
from models.recording import RecordingBlocks
from noise.base.labels import LABELS
from noise.base.tables import TABLE_ENDINGS
from noise.labels.table import HUMAN, read_label_table, table_recordings
from noise.labels.windows import has_window_channel, window_features
from noise.recordings import find_recordings
from noise.recordings.files import files_below, is_file, open_blocks
from noise.training.classifier.samples import Sample

SHORTEST, LONGEST = 0.1, 60.0
"""Minimum duration of a labelled stretch, and maximum duration of what is used of it [s]."""

OWN_WEIGHT = 5.0
"""Weight of a second of the user's, relative to a simulated sample."""


class _Stretch(NamedTuple):
    label: str
    start: float = 0.0
    end: float = math.inf
    channel: str = "all"


def own_samples(
    source: Path, progress: Callable[[Sequence[Path]], Iterable[Path]] = iter
) -> tuple[list[Sample], list[str]]:
    """Return the labelled stretches of a folder or of a label table as training samples.

    Parameters
    ----------
    source : Path
        Folder, searched recursively for recordings in folders named as labels; or a label table,
        with files relative to it.
    progress : callable, optional
        Function that yields the recordings and shows the progress.

    Returns
    -------
    samples : list of Sample
        Their sources are the files.
    refusals : list of str
        One line for each file that cannot be read or has no label, and for each invalid label.

    Raises
    ------
    RecordingError
        The file is no label table.

    Examples
    --------
    >>> import tempfile
    >>> from models.recording import Channel, Recording
    >>> from noise.recordings import write_recording
    >>> hiss = np.random.default_rng(0).normal(size=(1, 36_000))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     run = Recording(hiss, 16_000.0, (Channel("pressure"),))
    ...     _ = write_recording(Path(folder) / "none" / "wind", run)
    ...     samples, refusals = own_samples(Path(folder))
    >>> [sample.label for sample in samples], refusals
    (['none'], [])
    """
    samples: list[Sample] = []
    refusals: list[str] = []
    labelled = _from_table if source.is_file() else _from_folders
    stretches = labelled(source, refusals)
    for path in progress(list(stretches)):
        try:
            samples += _samples(path, stretches[path], refusals)
        except (BushingNoiseError, OSError) as error:
            message = str(error)
            refusals.append(message if path.name in message else f"{path}: {message}")
    return samples, refusals


def own_card(samples: Sequence[Sample], names: NDArray[np.intp]) -> dict[str, object]:
    """Return scores of the user's recordings for the card of the classifier.

    Parameters
    ----------
    samples : sequence of Sample
    names : ndarray of int, shape (n_samples,)
        Predicted columns of `LABELS`, by trees grown without the file of the sample.
    """
    y = np.array([LABELS.index(sample.label) for sample in samples])
    labels = {}
    for i, label in enumerate(LABELS):
        files, own = {s.source for s in samples if s.label == label}, y == i
        if files or np.any(names == i):
            labels[label] = {
                "files": len(files),
                "stretches": int(own.sum()),
                "recall": round(float(np.mean(names[own] == i)), 4) if own.any() else None,
                "false_names": int(np.sum((names == i) & ~own)),
            }
    return {"files": len({sample.source for sample in samples}), "labels": labels}


def _from_folders(folder: Path, refusals: list[str]) -> dict[Path, list[_Stretch]]:
    """Return the stretches of recordings by the nearest folder named as a label."""
    by_file = {}
    for path, _ in find_recordings(folder):
        above = (*reversed(path.relative_to(folder).parts[:-1]), folder.resolve().name)
        label = next((name.lower() for name in above if name.lower() in LABELS), None)
        if label is None:
            refusals.append(
                f"{path}: has no label; put it into a folder called {', '.join(LABELS)}, or give "
                "a label table"
            )
        else:
            by_file[path] = [_Stretch(label)]
    for path, _ in files_below(folder):
        if path.suffix.lower() in TABLE_ENDINGS:
            refusals.append(f"{path}: is not read; give a label table by itself")
    return by_file


def _from_table(table: Path, refusals: list[str]) -> dict[Path, list[_Stretch]]:
    """Return the stretches of a label table by file; of one with corrections, these alone.

    Its recordings are beside it or, as where the table is beside their folder, anywhere below.
    """
    by_file: dict[Path, list[_Stretch]] = {}
    unknown: set[str] = set()
    rows = [row for row in read_label_table(table, refusals) if row["label"] is not None]
    by_human = any(row["label_source"] == HUMAN for row in rows)
    files = {str(row["file"]) for row in rows}
    there = [path for path, _ in files_below(table.parent)]
    there += [beside for file in files if is_file(beside := table.parent / file)]
    paths = table_recordings(files, table, there)
    for row in rows:
        path = paths[str(row["file"])]
        if path is None:
            unknown.add(str(row["file"]))
        elif row["label_source"] == HUMAN or not by_human:
            start, end = row["start_s"], row["end_s"]
            stretch = _Stretch(
                str(row["label"]),
                start if isinstance(start, float) else 0.0,
                end if isinstance(end, float) else math.inf,
                str(row["channel"] or "all"),
            )
            by_file.setdefault(path, []).append(stretch)
    refusals += [
        f"{table}: names {file}, of which there is none or several" for file in sorted(unknown)
    ]
    return by_file


def _samples(path: Path, stretches: list[_Stretch], refusals: list[str]) -> Iterator[Sample]:
    """Yield the labelled stretches of a recording, each of at most a minute."""
    featureless = False
    with open_blocks(path) as whole:
        for label, start, end, channel in stretches:
            tracks = {str(i + 1): i for i in range(len(whole.channels))}
            if channel != "all" and channel not in tracks:
                refusals.append(
                    f"{path}: has no track {channel!r}; it has {len(tracks)}, counted from 1"
                )
                continue
            blocks = whole if channel == "all" else whole.track(tracks[channel])
            first = max(0, round(start * blocks.rate))
            last = round(min(end * blocks.rate, first + LONGEST * blocks.rate, blocks.n_samples))
            if last - first < SHORTEST * blocks.rate:
                refusals.append(
                    f"{path}: {label} from {start:g} s on has less than {SHORTEST:g} s in the "
                    "recording"
                )
                continue
            cut = RecordingBlocks.of(blocks.cut(first, last))
            features = window_features(cut).features if has_window_channel(cut) else None
            if features is None or not np.isfinite(features).any():
                featureless = True
                continue
            weight = OWN_WEIGHT * math.ceil((last - first) / blocks.rate)
            yield Sample(features, label, str(path), weight, real=True)
    if featureless:
        refusals.append(f"{path}: has nothing to learn from in it")
