"""Label table: one row per segment, with its columns, formats, reading and writing.

A table from elsewhere needs only the columns ``file`` and ``label``; missing columns are empty, and
additional columns are preserved.
"""

from __future__ import annotations

import math
import os
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from models.errors import RecordingError
from models.foreign_file import refusing
from noise.base.labels import LABELS
from noise.base.progress import counted, readable
from noise.base.tables import check_table_path, read_table, write_table

if TYPE_CHECKING:
    from pandas import DataFrame


CONDITIONS = {
    "speed_rad_s": "speed",
    "interference_mm": "interference",
    "support_stiffness_Nm_rad": "support_stiffness",
}
"""Fields of a condition by column."""

COLUMNS = (
    "file", "channel", "start_s", "end_s", "label", *(f"p_{label}" for label in LABELS),
    "frequency_hz", "level_db", "level_dba", "l_afmax_dba", "snr_dba", "level_dbfs", "calibrated",
    *(f"{name}{part}" for name in CONDITIONS for part in ("", "_low", "_high", "_source")),
    "material", "material_source", "label_source", "note", "error",
)  # fmt: skip
"""Columns of the table; all are always present."""


HUMAN, CLASSIFIER = "human", "classifier"
"""Values of `label_source` for labels by a person and by the program."""

_TEXTS = {
    "file", "channel", "label", "material", "note", "error",
    *(column for column in COLUMNS if column.endswith("_source")),
}  # fmt: skip
_NUMBERS = [column for column in COLUMNS if column not in {*_TEXTS, "calibrated"}]
NEEDED = ("file", "label")
"""Required columns of a label table."""

_TRUE = {"true", "1", "1.0", "wahr", "vrai", "verdadero", "verdadeiro", "vero", "waar", "prawda"}
_FALSE = {"false", "0", "0.0", "falsch", "faux", "falso", "onwaar", "fałsz"}
"""Truth values of spreadsheets in European languages, in lower case."""

_LARGEST = 1e12  # number in a cell, of any unit
_SUPPORT = "support_stiffness_Nm_rad"


class LabelTable(list[dict[str, object]]):
    """Label table of recordings: a list of one dict per segment, by `COLUMNS`.

    pandas and polars make a data frame of it as of any list of dictionaries; `to_pandas` preserves
    the order of the columns.

    Examples
    --------
    >>> row = {"file": "run07.wav", "label": "creak", "start_s": 0.0, "end_s": 1.0, "error": None}
    >>> LabelTable([row, {"file": "b.wav", "label": None, "error": "is empty"}]).refused
    {'b.wav': 'is empty'}
    >>> LabelTable([row])
    LabelTable(1 file; segments: 1 creak)
    """

    @property
    def refused(self) -> dict[str, str]:
        """Reasons why files could not be read, by file."""
        return {str(row["file"]): str(row["error"]) for row in self if row.get("error")}

    def write(self, path: str | Path) -> None:
        """Write the table atomically.

        Parameters
        ----------
        path : str or Path
            Ends in .csv, .xlsx, .jsonl or .parquet.

        Raises
        ------
        ParameterError
            The table cannot be written.
        """
        check_table_path(path)
        write_table(path, (*COLUMNS, *own_columns(self)), self)

    def to_pandas(self) -> DataFrame:
        """Return the table as a pandas data frame, by `COLUMNS`.

        Returns
        -------
        pandas.DataFrame
            The bolted clamp's support stiffness is ``inf``.

        Raises
        ------
        ParameterError
            pandas is not installed.
        """
        from models.show import data_frame

        return data_frame(COLUMNS, self)

    def __repr__(self) -> str:
        counts = Counter(str(row.get("label") or "refused") for row in self)
        files = counted(len({row.get("file") for row in self}), "file")
        numbers = ", ".join(f"{number} {label}" for label, number in counts.most_common())
        return f"LabelTable({files}; segments: {numbers or 'none'})"


def own_columns(rows: Iterable[Mapping[str, object]]) -> tuple[str, ...]:
    """Return the additional columns of rows, such as remarks.

    Examples
    --------
    >>> own_columns([{"file": "a.wav", "remark": "left door"}, {"file": "b.wav", "label": "none"}])
    ('remark',)
    """
    return tuple(dict.fromkeys(name for row in rows for name in row if name not in COLUMNS))


def read_label_table(path: Path, refusals: list[str] | None = None) -> list[dict[str, object]]:
    r"""Read a label table.

    Parameters
    ----------
    path : Path
        CSV, Excel, JSON Lines or Parquet file.
    refusals : list of str, optional
        List to which a line is appended for each invalid row, which is skipped; by default an
        invalid row is an error.

    Returns
    -------
    list of dict
        Rows by `noise.labels.table.COLUMNS` and additional columns; the support stiffness of the
        bolted clamp is ``inf``.

    Raises
    ------
    RecordingError
        The file cannot be read, or is no label table.
    ParameterError
        The file does not exist, or the library for its format is not installed.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "labels.csv"
    ...     _ = path.write_text("file,label,speed_rad_s\nrun07.wav,creak,5.0\n")
    ...     row, = read_label_table(path)
    >>> row["label"], row["speed_rad_s"], row["material"]
    ('creak', 5.0, None)
    """
    columns, rows = read_table(path, known=COLUMNS, numbers=_NUMBERS)
    missing = [column for column in NEEDED if column not in columns]
    if missing and path.suffix.lower() != ".jsonl":
        raise RecordingError(f"{path}: has no column {missing[0]!r}, so is no label table")
    checked = []
    for number, row in enumerate(rows, 1):
        where = f"{path}: row {number}"
        try:
            with refusing(where, "row of a label table", RecordingError):
                checked.append(_checked(row, where))
        except RecordingError as error:
            if refusals is None:
                raise
            refusals.append(str(error))
    return checked


def table_recordings(
    files: Iterable[str], table: Path, paths: Sequence[Path], names: Sequence[str] = ()
) -> dict[str, Path | None]:
    """Return the recording of each file that a label table names; None without exactly one.

    Parameters
    ----------
    files : iterable of str
        As the table names them: relative to some folder, which the table does not state.
    table : Path
    paths : sequence of Path
        Recordings.
    names : sequence of str
        Names of the recordings that have priority, such as in a table that they were written to.

    Returns
    -------
    dict of str to Path or None
        The recording of that name, else the one at that place beside the table, else the only one
        whose path ends so.

    Examples
    --------
    >>> runs = [Path("day1/a.wav"), Path("day2/a.wav"), Path("day2/b.wav")]
    >>> found = table_recordings(["a.wav", "b.wav", "day1/a.wav"], Path("labels.csv"), runs)
    >>> [path and path.as_posix() for path in found.values()]
    [None, 'day2/b.wav', 'day1/a.wav']
    """
    by_name = dict(zip(names, paths, strict=False))
    by_place = {path.resolve(): path for path in paths}
    by_ending = [(readable(place.as_posix()), path) for place, path in by_place.items()]
    folder = table.resolve().parent

    def find(file: str) -> Path | None:
        if file in by_name:
            return by_name[file]
        if (beside := (folder / file).resolve()) in by_place:
            return by_place[beside]
        alike = [path for place, path in by_ending if place.endswith(f"/{file}")]
        return alike[0] if len(alike) == 1 else None

    return {file: find(file) for file in dict.fromkeys(files)}


def _checked(row: object, where: str) -> dict[str, object]:
    if not isinstance(row, dict) or any(column not in row for column in NEEDED):
        raise RecordingError(f"{where} lacks {' or '.join(NEEDED)}, so this is no label table")
    checked = {name: value for name, value in row.items() if name not in COLUMNS}
    checked = {column: _value(row, column, where) for column in COLUMNS} | checked
    for column in ("file", "channel"):  # used for names of files and for lines of text
        check_name(checked[column], column, where)
    if checked["label"] not in (*LABELS, None):
        known = ", ".join(LABELS)
        raise RecordingError(f"{where} has label {checked['label']!r}, expected {known}")
    source = checked[f"{_SUPPORT}_source"]
    stiff = [_SUPPORT] if source in ("logged", "inferred") else []
    stiff += [f"{_SUPPORT}_low", f"{_SUPPORT}_high"] if source == "inferred" else []
    for column in stiff:
        if checked[column] is None:
            checked[column] = math.inf  # JSON has no infinity
    return checked


def _value(row: Mapping[str, object], column: str, where: str) -> object:
    value = row.get(column)
    if value is None or value == "":
        return None
    if column == "file":
        return str(value)
    if isinstance(value, float) and value.is_integer():  # spreadsheets store the track as a number
        value = int(value)
    text = str(value).strip()
    if column == "label_source":  # any other source is a person
        return text.lower() if text.lower() == CLASSIFIER else HUMAN
    if column == "label":
        return text.lower() or None
    if column in _TEXTS:
        return text or None
    if column == "calibrated":
        if text.lower() not in _TRUE | _FALSE:
            raise RecordingError(f"{where} has {column} {text!r}, expected true or false")
        return text.lower() in _TRUE
    if text in ("fixed", "inf") and column.startswith(_SUPPORT):
        return math.inf
    try:
        number = float(str(value))
    except ValueError:
        raise RecordingError(f"{where} has {column} {value!r}, expected a number") from None
    if abs(number) > _LARGEST:
        raise RecordingError(f"{where} has {column} {value!r}, expected a number that is possible")
    return None if math.isnan(number) else number


def check_name(value: object, column: str, where: str) -> None:
    r"""Refuse a file name in a table that no file can have.

    Raises
    ------
    RecordingError
        The name is impossible; the message contains its place.

    Examples
    --------
    >>> check_name("day1/run07.wav", "file", "labels.csv: row 1")
    >>> check_name("a\0b", "file", "labels.csv: row 1")
    Traceback (most recent call last):
    models.errors.RecordingError: labels.csv: row 1 has file 'a\x00b', which is the name of none
    """
    try:
        possible = b"\0" not in os.fsencode(str(value))
    except UnicodeEncodeError:
        possible = False
    if not possible:
        raise RecordingError(f"{where} has {column} {value!r}, which is the name of none")
