"""Labelled recordings of the user, as training samples.

Labels come from a row of a label table of ``bushing-noise label``, else from the name of a folder
above the recording (``creak/run07.wav``). Of a table with corrections (`label_source` is
``human``), only the corrections are used. Unusable files and labels are skipped, each with one line
of explanation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.blocks import RecordingBlocks
from models.errors import BushingNoiseError, RecordingError
from noise.base.labels import LABELS
from noise.base.tables import TABLE_ENDINGS
from noise.labels.table import HUMAN, read_label_table
from noise.labels.windows import has_window_channel, window_features
from noise.recordings import find_recordings
from noise.recordings.files import files_below, is_file, open_blocks
from noise.training.classifier.samples import Sample

LONGEST_WINDOW = 1.0
"""Maximum duration of the equal windows of a stretch [s]."""

SHORTEST_WINDOW = 0.1
"""Minimum duration of a labelled stretch [s]."""

OWN_WEIGHT = 5.0
"""Weight of a window of the user, relative to a simulated sample."""


class _Stretch(NamedTuple):
    label: str
    start: float = 0.0
    end: float = math.inf
    channel: str = "all"


_Labels = dict[Path, list[_Stretch]]


def own_samples(
    source: Path, progress: Callable[[Sequence[Path]], Iterable[Path]] = iter
) -> tuple[list[Sample], list[str]]:
    """Return the labelled windows of a folder or of a label table as training samples.

    Parameters
    ----------
    source : Path
        Folder, searched recursively for recordings and label tables; or a label table, with files
        relative to it.
    progress : callable, optional
        Function that yields the recordings and shows the progress.

    Returns
    -------
    samples : list of Sample
        Windows of at most 1 s, whose sources are the files.
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
    (['none', 'none', 'none'], [])
    """
    samples: list[Sample] = []
    refusals: list[str] = []
    if source.is_file():
        tabled = _from_table(source, source.parent, refusals)
        paths = list(tabled)
    else:
        tabled = _from_tables(source, refusals)
        paths = [path for path, _ in find_recordings(source)]
        present = {path.resolve() for path in paths}
        paths += [path for path, stretches in tabled.items() if stretches and path not in present]
    for path in progress(paths):
        try:
            stretches = tabled.get(path.resolve())
            if not stretches and source.is_dir():
                stretches = _from_folders(path, source) or stretches
            if stretches is None:
                raise RecordingError(
                    f"{path}: has no label; put it into a folder called {', '.join(LABELS)}, or "
                    "beside a label table"
                )
            samples += _windows(path, stretches, refusals)  # empty without corrections
        except (BushingNoiseError, OSError) as error:
            refusals.append(_naming(path, str(error)))
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
                "windows": int(own.sum()),
                "enough": len(files) >= 5,
                "recall": round(float(np.mean(names[own] == i)), 4) if own.any() else None,
                "false_names": int(np.sum((names == i) & ~own)),
            }
    return {
        "weight": OWN_WEIGHT,
        "files": len({sample.source for sample in samples}),
        "labels": labels,
    }


def _from_folders(path: Path, folder: Path) -> list[_Stretch]:
    """Return the stretch with the label of the nearest folder named as a label, if any."""
    above = (*reversed(path.relative_to(folder).parts[:-1]), folder.resolve().name)
    label = next((name.lower() for name in above if name.lower() in LABELS), None)
    return [] if label is None else [_Stretch(label)]


def _from_tables(folder: Path, refusals: list[str]) -> _Labels:
    """Return the stretches of all label tables in a folder, by file."""
    by_file: _Labels = {}
    tables = (path for path, _ in files_below(folder) if path.suffix.lower() in TABLE_ENDINGS)
    for table in sorted(tables):
        try:
            of_table = _from_table(table, folder, refusals)
        except BushingNoiseError as error:
            refusals.append(_naming(table, str(error)))
            continue
        for path, stretches in of_table.items():
            by_file.setdefault(path, []).extend(stretches)
    return by_file


def _from_table(table: Path, folder: Path, refusals: list[str]) -> _Labels:
    """Return the stretches of a label table by file.

    If the table has corrections, files without corrections have no stretches.
    """
    by_file: _Labels = {}
    unknown = set()
    rows = [row for row in read_label_table(table, refusals) if row["label"] is not None]
    by_human = any(row["label_source"] == HUMAN for row in rows)
    for row in rows:
        file = str(row["file"])
        there = [p.resolve() for p in (table.parent / file, folder / file) if is_file(p)]
        if not there:
            unknown.add(file)
            continue
        stretches = by_file.setdefault(there[0], [])
        if by_human and row["label_source"] != HUMAN:
            continue
        start, end = row["start_s"], row["end_s"]
        stretches.append(
            _Stretch(
                str(row["label"]),
                start if isinstance(start, float) else 0.0,
                end if isinstance(end, float) else math.inf,
                str(row["channel"] or "all"),
            )
        )
    refusals += [f"{table}: names {file}, which is not there" for file in sorted(unknown)]
    return by_file


def _windows(path: Path, stretches: list[_Stretch], refusals: list[str]) -> Iterator[Sample]:
    """Yield the windows of the labelled stretches of a recording."""
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
            last = round(min(end * blocks.rate, blocks.n_samples))
            if last - first < SHORTEST_WINDOW * blocks.rate:
                refusals.append(
                    f"{path}: {label} from {start:g} s on has less than {SHORTEST_WINDOW:g} s in "
                    "the recording"
                )
                continue
            n = math.ceil((last - first) / (LONGEST_WINDOW * blocks.rate))
            edges = np.linspace(first, last, n + 1).round().astype(int)
            # At most 60 windows, spread evenly
            chosen = np.unique(np.linspace(0, n - 1, min(n, 60)).round().astype(int))
            for index in chosen.tolist():
                cut = RecordingBlocks.of(blocks.cut(int(edges[index]), int(edges[index + 1])))
                features = window_features(cut).features if has_window_channel(cut) else None
                if features is None or not np.isfinite(features).any():
                    featureless = True
                    continue
                yield Sample(features, label, str(path), OWN_WEIGHT, real=True)
    if featureless:
        refusals.append(f"{path}: has nothing to learn from in it")


def _naming(path: Path, message: str) -> str:
    return message if path.name in message else f"{path}: {message}"
