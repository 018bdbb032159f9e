r"""Labelled recordings of the user, as training samples.

Labels come from a label track of Audacity (``run07.txt`` or ``run07.wav.txt`` beside
``run07.wav``), else from a row of a label table of ``bushing-noise label``, else from the name of a
folder above the recording (``creak/run07.wav``). Of a table with corrections (`label_source` is
``human``), only the corrections are used. Unusable files and labels are skipped, each with one line
of explanation.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.blocks import RecordingBlocks
from models.errors import BushingNoiseError, RecordingError
from models.recording import Recording
from noise.base.labels import LABELS
from noise.base.tables import TABLE_ENDINGS
from noise.labels.segmentation import NOISES
from noise.labels.table import HUMAN, read_label_table
from noise.labels.tracks import read_label_track
from noise.labels.windows import has_window_channel, window_features
from noise.recordings import find_recordings
from noise.recordings.files import open_blocks
from noise.recordings.folders import files_below, is_file
from noise.training.classifier.samples import Sample

LONGEST_WINDOW = 1.0
"""Maximum duration of the equal windows of a stretch [s]."""

SHORTEST_WINDOW = 0.1
"""Minimum duration of a labelled stretch [s]."""

MOST_WINDOWS = 60
"""Maximum number of windows of a stretch, spread evenly over it."""

OWN_WEIGHT = 5.0
"""Weight of a window of the user, relative to a simulated sample."""

TOO_FEW = 5
"""Minimum number of files of a label for a meaningful score."""


@dataclass(frozen=True, eq=False)
class OwnWindow:
    """Window of a labelled recording.

    Parameters
    ----------
    recording : Recording
    label : str
        One of `noise.classifier.LABELS`.
    name : str
        Path of the file.
    """

    recording: Recording
    label: str
    name: str


@dataclass(frozen=True)
class _Stretch:
    label: str
    start: float = 0.0
    end: float = math.inf
    channel: str = "all"


def read_labelled(source: Path) -> tuple[list[OwnWindow], list[str]]:
    """Return the labelled windows of a folder or of a label table.

    Parameters
    ----------
    source : Path
        Folder, searched recursively for recordings, label tables and label tracks; or a label
        table, with files relative to it.

    Returns
    -------
    windows : list of OwnWindow
        Windows of at most 1 s, sorted by file.
    refusals : list of str
        One line for each file that cannot be read or has no label, and for each invalid label.

    Raises
    ------
    ParameterError
        The source does not exist.
    RecordingError
        The file is no label table.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from models.recording import Channel, Recording
    >>> from noise.recordings import write_recording
    >>> hiss = np.random.default_rng(0).normal(size=(1, 36_000))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     run = Recording(hiss, 16_000.0, (Channel("pressure"),))
    ...     _ = write_recording(Path(folder) / "none" / "wind", run)
    ...     windows, refusals = read_labelled(Path(folder))
    >>> [(window.label, window.recording.duration) for window in windows], refusals
    ([('none', 0.75), ('none', 0.75), ('none', 0.75)], [])
    """
    refusals: list[str] = []
    windows: list[OwnWindow] = []
    if source.is_file():
        tabled = _from_table(source, source.parent, None, refusals)
        recordings = list(tabled)
    else:
        recordings = [path for path, _ in find_recordings(source)]
        tabled = _from_tables(source, {path.resolve() for path in recordings}, refusals)
    for path in recordings:
        try:
            stretches = tabled.get(path.resolve())
            if source.is_dir():
                folders = _from_folders(path, source)
                stretches = _from_track(path, refusals) or stretches or folders or stretches
            if stretches is None:
                known = ", ".join(LABELS)
                raise RecordingError(
                    f"{path}: has no label; put it into a folder called {known}, or beside a "
                    "label table or a label track"
                )
            windows += _windows(path, stretches, refusals)  # empty without corrections
        except (BushingNoiseError, OSError) as error:
            refusals.append(_naming(path, str(error)))
    return windows, refusals


def own_samples(windows: Iterable[OwnWindow]) -> tuple[list[Sample], list[str]]:
    """Return labelled windows as training samples.

    Parameters
    ----------
    windows : iterable of OwnWindow

    Returns
    -------
    samples : list of Sample
        Samples, whose sources are the files.
    refusals : list of str
        One line for each file with a window without features.
    """
    samples: list[Sample] = []
    refusals: dict[str, str] = {}
    for window in windows:
        blocks = RecordingBlocks.of(window.recording)
        if has_window_channel(blocks):
            features = window_features(blocks).features
            if np.isfinite(features).any():
                samples.append(Sample(features, window.label, window.name, OWN_WEIGHT, real=True))
                continue
        refusals.setdefault(window.name, f"{window.name}: has nothing to learn from in it")
    return samples, list(refusals.values())


def own_card(
    samples: Sequence[Sample], before: NDArray[np.intp], after: NDArray[np.intp]
) -> dict[str, object]:
    """Return scores of the user's recordings for the card of the classifier.

    Parameters
    ----------
    samples : sequence of Sample
    before, after : ndarray of int, shape (n_samples,)
        Predicted columns of `LABELS`, by trees grown without the user's recordings, and by trees
        grown without the file of the sample.
    """
    y = np.array([LABELS.index(sample.label) for sample in samples])
    labels = {}
    for i, label in enumerate(LABELS):
        files, own = {s.source for s in samples if s.label == label}, y == i
        if files or np.any(after == i):
            labels[label] = {
                "files": len(files),
                "windows": int(own.sum()),
                "enough": len(files) >= TOO_FEW,
                "recall_before": _share(before[own] == i),
                "recall": _share(after[own] == i),
                "false_names_before": int(np.sum((before == i) & ~own)),
                "false_names": int(np.sum((after == i) & ~own)),
            }
    return {
        "weight": OWN_WEIGHT,
        "files": len({sample.source for sample in samples}),
        "noises": int(np.sum(y < NOISES)),
        "labels": labels,
    }


def _share(right: NDArray[np.bool_]) -> float | None:
    return round(float(np.mean(right)), 4) if right.size else None


def _from_folders(path: Path, folder: Path) -> list[_Stretch]:
    """Return the stretch with the label of the nearest folder named as a label, if any."""
    above = (*reversed(path.relative_to(folder).parts[:-1]), folder.resolve().name)
    label = next((name.lower() for name in above if name.lower() in LABELS), None)
    return [] if label is None else [_Stretch(label)]


def _from_track(path: Path, refusals: list[str]) -> list[_Stretch]:
    """Return the stretches of the label track beside a recording."""
    of_recording = []
    for track in (path.with_suffix(".txt"), path.with_name(f"{path.name}.txt")):
        if not track.is_file():
            continue
        for number, (start, end, channel, label) in enumerate(read_label_track(track), 1):
            if label.lower() in LABELS:
                of_recording.append(_Stretch(label.lower(), start, end, channel))
            else:
                refusals.append(
                    f"{track}: label {number} is {label!r}, expected {', '.join(LABELS)}"
                )
        if not of_recording:
            raise RecordingError(f"{track}: holds no label of ours, so {path.name} is left out")
    return of_recording


def _from_tables(
    folder: Path, recordings: set[Path], refusals: list[str]
) -> dict[Path, list[_Stretch]]:
    """Return the stretches of all label tables in a folder, by file."""
    by_file: dict[Path, list[_Stretch]] = {}
    tables = (path for path, _ in files_below(folder) if path.suffix.lower() in TABLE_ENDINGS)
    for table in sorted(tables):
        try:
            of_table = _from_table(table, folder, recordings, refusals)
        except BushingNoiseError as error:
            refusals.append(_naming(table, str(error)))
            continue
        for path, stretches in of_table.items():
            by_file.setdefault(path, []).extend(stretches)
    return by_file


def _from_table(
    table: Path, folder: Path, recordings: set[Path] | None, refusals: list[str]
) -> dict[Path, list[_Stretch]]:
    """Return the stretches of a label table by file, by default of all existing files.

    If the table has corrections, files without corrections have no stretches.
    """
    by_file: dict[Path, list[_Stretch]] = {}
    unknown = set()
    rows = [row for row in read_label_table(table, refusals) if row["label"] is not None]
    by_human = any(row["label_source"] == HUMAN for row in rows)
    for row in rows:
        file = str(row["file"])
        places = [p.resolve() for p in (table.parent / file, folder / file)]
        there = [p for p in places if (is_file(p) if recordings is None else p in recordings)]
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


def _windows(path: Path, stretches: list[_Stretch], refusals: list[str]) -> Iterator[OwnWindow]:
    with open_blocks(path) as whole:
        for stretch in stretches:
            number = 0 if stretch.channel == "all" else _track_number(stretch.channel, whole)
            if number is None:
                refusals.append(
                    f"{path}: has no track {stretch.channel!r}; it has {len(whole.channels)}, "
                    "counted from 1"
                )
                continue
            blocks = whole.track(number - 1) if number else whole
            first = max(0, round(stretch.start * blocks.rate))
            last = round(min(stretch.end * blocks.rate, blocks.n_samples))
            if last - first < SHORTEST_WINDOW * blocks.rate:
                refusals.append(
                    f"{path}: {stretch.label} from {stretch.start:g} s on has less than "
                    f"{SHORTEST_WINDOW:g} s in the recording"
                )
                continue
            n = math.ceil((last - first) / (LONGEST_WINDOW * blocks.rate))
            edges = np.linspace(first, last, n + 1).round().astype(int)
            chosen = np.unique(np.linspace(0, n - 1, min(n, MOST_WINDOWS)).round().astype(int))
            for index in chosen.tolist():
                cut = blocks.cut(int(edges[index]), int(edges[index + 1]))
                yield OwnWindow(cut, stretch.label, str(path))


def _track_number(channel: str, blocks: RecordingBlocks) -> int | None:
    known = channel.isdecimal() and 0 < int(channel) <= len(blocks.channels)
    return int(channel) if known else None


def _naming(path: Path, message: str) -> str:
    return message if path.name in message else f"{path}: {message}"
