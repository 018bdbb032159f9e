"""Inputs of a review: paths sorted by content, and their recordings.

A file is taken at its word and refused where it is not what its ending says. A folder is searched:
what in it is of no known kind, such as a table of features, is passed over, because folders of
measurements hold all sorts of things. Refusals are collected, for a review that lacks one bad file
is better than none. A recording is cut as it is read: a campaign may be larger than memory.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.blocks import RecordingBlocks
from models.errors import BushingNoiseError, ParameterError
from models.recording import Recording
from models.show import short_repr
from noise.audio.sound import LOWEST_AUDIBLE_RATE, audible
from noise.audio.spectrogram import recorded_levels
from noise.base.progress import readable, track
from noise.base.tables import TABLE_ENDINGS, table_columns
from noise.classifier import Classifier, load_classifier
from noise.labels.rows import label_rows
from noise.labels.segments import label_recording
from noise.labels.table import read_label_table
from noise.pages.clips import BYTES_A_SECOND, RATE, SHORTEST, Entry, FastLevels, Row, stretch_start
from noise.recordings import find_recordings
from noise.recordings.files import open_blocks
from noise.recordings.folders import files_below, is_file
from noise.recordings.formats import formats
from noise.recordings.interpretation import PascalPerFullScale

DIAGNOSIS = "diagnosis.json"
"""File name of a diagnosis."""

_MOST_FOLDERS = 8
"""Maximum number of folders in a unique name."""

_OF_A_SCREEN = {"design", "speed_rad_s", "interference_mm", "label"}
_OF_LABELS = {"file", "label"}


@dataclass(frozen=True)
class Refusal:
    """Refused input and the reason."""

    name: str
    reason: str

    @classmethod
    def of(cls, path: Path, error: BushingNoiseError | str) -> Refusal:
        """Return the refusal of a file; its path is removed from the error message.

        Examples
        --------
        >>> from pathlib import Path
        >>> Refusal.of(Path("run07.wav"), "run07.wav: is empty").reason
        'is empty'
        """
        return cls(readable(str(path)), readable(str(error).removeprefix(f"{path}: ")))


@short_repr
@dataclass(frozen=True)
class LabelTable:
    """Label table and its path."""

    path: Path
    rows: tuple[Row, ...]

    def of(self, recording: Path) -> tuple[Row, ...]:
        """Return the rows of a recording.

        A row's file is relative to some folder that the table does not name: so it is one below
        the table's own folder, or else any whose path ends like it.
        """
        resolved = recording.resolve()
        beside = tuple(r for r in self.rows if self._named(r) == resolved)
        ending = readable(resolved.as_posix())  # as tables have it
        return beside or tuple(r for r in self.rows if ending.endswith(f"/{r['file']}"))

    def _named(self, row: Row) -> Path:
        return (self.path.parent / str(row["file"])).resolve()


@dataclass(frozen=True)
class Inputs:
    """Input paths by content.

    Parameters
    ----------
    recordings : tuple of (Path, str)
        Each with its name, as `noise.recordings.find_recordings` gives it.
    tables : tuple of LabelTable
    screens, diagnoses, designs : tuple of Path
        Maps of screens, files of diagnoses, rig files of designs.
    refused : tuple of Refusal
    """

    recordings: tuple[tuple[Path, str], ...]
    tables: tuple[LabelTable, ...]
    screens: tuple[Path, ...]
    diagnoses: tuple[Path, ...]
    designs: tuple[Path, ...]
    refused: tuple[Refusal, ...]


def sort_inputs(paths: Iterable[Path]) -> Inputs:
    r"""Sort paths by content.

    Parameters
    ----------
    paths : iterable of Path
        Recordings, label tables, rig files (``.toml``), maps of a screen, diagnoses, and folders
        of them at any depth.

    Raises
    ------
    ParameterError
        A path does not exist, or the paths contain nothing for a review.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as name:
    ...     folder = Path(name)
    ...     _ = (folder / "run07.wav").write_bytes(b"")
    ...     _ = (folder / "labels.csv").write_text("file,label\nrun07.wav,creak\n")
    ...     _ = (folder / "features.csv").write_text("file,rms\nrun07.wav,0.1\n")
    ...     found = sort_inputs([folder])
    ...     [name for _, name in found.recordings], len(found.tables), found.refused
    (['run07.wav'], 1, ())
    """
    kinds: dict[str, list[Path]] = {kind: [] for kind in ("table", *_KINDS)}
    recordings: dict[Path, tuple[Path, str]] = {}
    for path in paths:
        inside_path = find_recordings(path)  # complains of what is not there
        if path.is_dir():
            for inside, file in _inside(path):
                kinds[inside].append(file)
            recordings |= {file.resolve(): (file, name) for file, name in _originals(inside_path)}
            continue
        if _is_sidecar(path):
            continue
        kind = _kind_of_file(path)
        if kind is None:
            recordings.setdefault(path.resolve(), (path, path.name))
        else:
            kinds[kind].append(path)
    tables, refused = _read_tables(kinds["table"])
    inputs = Inputs(
        unique_names(list(recordings.values())),
        tuple(tables),
        _each_once(kinds["screen"]),
        _each_once(kinds["diagnosis"]),
        _each_once(kinds["design"]),
        tuple(refused),
    )
    if not (recordings or tables or refused or inputs.screens or inputs.diagnoses):
        raise ParameterError(
            f"{', '.join(map(str, paths))}: there are no recordings, labels, screens or diagnoses"
        )
    return inputs


_KINDS = ("screen", "diagnosis", "design")


def _kind_of_file(path: Path) -> str | None:
    ending = path.suffix.lower()
    if ending in TABLE_ENDINGS:
        return "screen" if table_columns(path) >= _OF_A_SCREEN else "table"
    return {".json": "diagnosis", ".toml": "design"}.get(ending)


def _is_sidecar(path: Path) -> bool:
    """Whether a file is the sidecar of a recording."""
    if path.suffix.lower() != ".json" or path.name == DIAGNOSIS:
        return False
    return any(path.with_suffix(ending).is_file() for ending in formats())


def _inside(folder: Path) -> Iterator[tuple[str, Path]]:
    for path, _ in sorted(files_below(folder)):
        if path.name == DIAGNOSIS:
            yield "diagnosis", path
        elif path.suffix.lower() in TABLE_ENDINGS:
            columns = table_columns(path)
            if columns >= _OF_A_SCREEN:
                yield "screen", path
            elif columns >= _OF_LABELS:
                yield "table", path


def _originals(files: Sequence[tuple[Path, str]]) -> Iterator[tuple[Path, str]]:
    """Yield files without ``audio/run07.wav`` beside ``recordings/run07.wav``."""
    there = {path.resolve() for path, _ in files}
    for path, name in files:
        folder = path.parent.resolve()
        original = folder.parent / "recordings" / path.name
        if not (folder.name == "audio" and original.resolve() in there):
            yield path, name


def unique_names(files: list[tuple[Path, str]]) -> tuple[tuple[Path, str], ...]:
    """Make names of recordings unique by adding folders.

    Parameters
    ----------
    files : list of (Path, str)
        Recordings and their names.

    Examples
    --------
    >>> from pathlib import Path
    >>> named = unique_names([(Path("/a/run.wav"), "run.wav"), (Path("/b/run.wav"), "run.wav")])
    >>> [name for _, name in named]
    ['a/run.wav', 'b/run.wav']
    """
    for _ in range(_MOST_FOLDERS):
        counts = Counter(name for _, name in files)
        if max(counts.values(), default=0) < 2:
            break
        files = [
            (path, _with_folder(path, name) if counts[name] > 1 else name) for path, name in files
        ]
    return tuple(files)


def _with_folder(path: Path, name: str) -> str:
    parts = path.resolve().parts
    return "/".join(parts[-(name.count("/") + 2) :])


def _read_tables(paths: Iterable[Path]) -> tuple[list[LabelTable], list[Refusal]]:
    tables, refused = [], []
    for path in _each_once(paths):
        lines: list[str] = []
        try:
            rows = read_label_table(path, lines)
            tables.append(LabelTable(path, tuple(rows)))
        except BushingNoiseError as error:
            lines.append(str(error))
        refused += [Refusal.of(path, line) for line in lines]
    return tables, refused


def _each_once(paths: Iterable[Path]) -> tuple[Path, ...]:
    return tuple({path.resolve(): path for path in paths}.values())


_GENEROUS = 4.0
"""Ratio of the sizes of loud noise and quiet sounds."""


def recorded_entries(
    inputs: Inputs,
    refused: list[Refusal],
    *,
    seconds: float,
    full_scale: PascalPerFullScale | None,
    budget: float,
    classify: bool,
) -> list[Entry]:
    """Read recordings, and entries of tables whose recordings are missing.

    Parameters
    ----------
    inputs : Inputs
    refused : list of Refusal
        Takes what cannot be read.
    seconds : float
        Maximum duration of an excerpt [s].
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
    new = [entry for entry in named if entry[0].resolve() not in known]
    files = list(unique_names([*files, *new]))
    needs = classify and any(not _labelled(path, inputs.tables) for path, _ in files)
    classifier = load_classifier() if needs else None
    # What could never fit is not read at all.
    longest = min(
        seconds, max(SHORTEST, _GENEROUS * budget / (BYTES_A_SECOND * max(1, len(files))))
    )
    entries: list[Entry] = []
    for path, name in track(files, "reading"):
        entry = _read_entry(
            path, name, inputs.tables, classifier, longest=longest, full_scale=full_scale
        )
        if isinstance(entry, Refusal):
            refused.append(entry)
        else:
            entries.append(entry)
    return entries + _missing(inputs.tables, [path for path, _ in files])


def _labelled(path: Path, tables: Sequence[LabelTable]) -> bool:
    return any(row["label"] is not None for table in tables for row in table.of(path))


def _named_by_tables(tables: Sequence[LabelTable], given: Sequence[Path]) -> list[tuple[Path, str]]:
    """Return further recordings that tables name beside or below their folder."""
    files: dict[Path, tuple[Path, str]] = {}
    for table in tables:
        there = _files_of(table, given)
        for name in dict.fromkeys(str(row["file"]) for row in table.rows):
            if name in there:
                continue
            for path in (table.path.parent / name, *_below(table.path.parent, name)):
                if is_file(path):
                    files.setdefault(path.resolve(), (path, name))
                    break
    return list(files.values())


def _files_of(table: LabelTable, recordings: Sequence[Path]) -> set[str]:
    """Return the names in a table of the given recordings."""
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
    """Read the entry of a recording.

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
        Maximum duration of the excerpt [s].
    full_scale : float or tuple of float, optional
        As for `noise.recordings.read_recording`.
    """
    try:
        rows = next(filter(None, (table.of(path) for table in tables)), ())
        with open_blocks(path, full_scale=full_scale) as blocks:
            note = ""
            if any(row["label"] is not None for row in rows):
                note = "labelled by the table"
            elif classifier is not None:
                note = "labelled for this page"
                rows = tuple(label_rows(name, blocks, label_recording(blocks, classifier)))
            duration = blocks.n_samples / blocks.rate
            offset = stretch_start(rows, duration, longest)
            excerpt, why = _excerpt(blocks, offset, longest)
            sound, levels = (None, None) if excerpt is None else _sound(excerpt)
    except BushingNoiseError as error:
        return Refusal.of(path, error)
    except OSError as error:  # it was there when the folder was searched
        return Refusal.of(path, f"cannot be read ({error.strerror or error})")
    return Entry(
        name, tuple(rows), blocks.condition, duration, sound, offset,
        blocks.calibrated, "; ".join(filter(None, (note, why))),
        None if levels is None else (offset + levels[0], levels[1]),
    )  # fmt: skip


def _excerpt(
    blocks: RecordingBlocks, offset: float, longest: float
) -> tuple[Recording | None, str]:
    """Return the audible excerpt and a remark; None without sound."""
    row = blocks.first("pressure")
    if row is None:
        return None, "no sound pressure to be heard"
    if blocks.rate < LOWEST_AUDIBLE_RATE:
        return None, f"sampled at {blocks.rate:g} Hz, so nothing can be heard"
    first = round(offset * blocks.rate)
    last = min(blocks.n_samples, first + round(longest * blocks.rate))
    others = sum(channel.kind == "pressure" for channel in blocks.channels) - 1
    excerpt = blocks.track(row).cut(first, last)
    return excerpt, f"1 of {others + 1} channels is heard" if others else ""


def _sound(excerpt: Recording) -> tuple[NDArray[np.float32], FastLevels]:
    """Return the sound at the rate of the page, and its original level over time."""
    return audible(excerpt, RATE).astype(np.float32), recorded_levels(excerpt)
