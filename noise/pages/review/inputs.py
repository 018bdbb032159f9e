"""Inputs of a review: the paths that were named, sorted by what they hold.

A file is taken at its word and refused where it is not what its ending says. A folder is searched:
what in it is of no known kind, such as a table of features, is passed over, because folders of
measurements hold all sorts of things. Refusals are collected, for a review that lacks one bad file
is better than none.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from models.errors import BushingNoiseError, ParameterError
from models.show import short_repr
from noise.base.readable import readable
from noise.base.tables import TABLE_ENDINGS, table_columns
from noise.labels.table import read_label_table
from noise.recordings import find_recordings
from noise.recordings.folders import files_below
from noise.recordings.formats import formats

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

__all__ = ["DIAGNOSIS", "Inputs", "LabelTable", "Refusal", "sort_inputs", "told_apart"]

DIAGNOSIS = "diagnosis.json"
"""What a folder of a diagnosis holds."""

_MOST_FOLDERS = 8
"""That a name is lengthened by, to tell it from another."""

_OF_A_SCREEN = {"design", "speed_rad_s", "interference_mm", "label"}
_OF_LABELS = {"file", "label"}

Row = dict[str, object]


@dataclass(frozen=True)
class Refusal:
    """An input that could not be used, and why."""

    name: str
    reason: str

    @classmethod
    def of(cls, path: Path, error: BushingNoiseError | str) -> Refusal:
        """Refuse a file for an error, whose message may begin with its path.

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
    """A label table and where it lies."""

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
    """Paths by what they hold.

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
    r"""Sort paths by what they hold.

    Parameters
    ----------
    paths : iterable of Path
        Recordings, label tables, rig files (``.toml``), maps of a screen, diagnoses, and folders
        of them at any depth.

    Raises
    ------
    ParameterError
        A path does not exist, or nothing of a review is in them.

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
        found = find_recordings(path)  # complains of what is not there
        if path.is_dir():
            for inside, file in _inside(path):
                kinds[inside].append(file)
            recordings |= {file.resolve(): (file, name) for file, name in _originals(found)}
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
        told_apart(list(recordings.values())),
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
    """Whether it only describes the recording beside it, as in ``review recordings/*``."""
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


def _originals(found: Sequence[tuple[Path, str]]) -> Iterator[tuple[Path, str]]:
    """Leave out ``audio/run07.wav`` beside ``recordings/run07.wav``: the same made to be heard."""
    there = {path.resolve() for path, _ in found}
    for path, name in found:
        folder = path.parent.resolve()
        original = folder.parent / "recordings" / path.name
        if not (folder.name == "audio" and original.resolve() in there):
            yield path, name


def told_apart(found: list[tuple[Path, str]]) -> tuple[tuple[Path, str], ...]:
    """Name the folder above as well where two recordings have the same name.

    Parameters
    ----------
    found : list of (Path, str)
        Recordings and their names.

    Examples
    --------
    >>> from pathlib import Path
    >>> named = told_apart([(Path("/a/run.wav"), "run.wav"), (Path("/b/run.wav"), "run.wav")])
    >>> [name for _, name in named]
    ['a/run.wav', 'b/run.wav']
    """
    for _ in range(_MOST_FOLDERS):
        counts = Counter(name for _, name in found)
        if max(counts.values(), default=0) < 2:
            break
        found = [
            (path, _with_folder(path, name) if counts[name] > 1 else name) for path, name in found
        ]
    return tuple(found)


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
