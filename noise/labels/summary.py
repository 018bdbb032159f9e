"""Summary of the label rows of a recording: main label, all labels, and a line of text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import groupby

from noise.base.labels import NAMED

ASSUMED = "assuming a fluorocarbon bushing like the shipped one"
"""Remark on inferred conditions without a logged material."""


def assumes_material(row: Mapping[str, object]) -> bool:
    """Whether a row of the label table has inferred conditions but no logged material.

    Examples
    --------
    >>> row = {"speed_rad_s_source": "inferred", "material_source": "missing"}
    >>> assumes_material(row), assumes_material(row | {"material_source": "logged"})
    (True, False)
    """
    sources = (value for column, value in row.items() if column.endswith("_source"))
    return "inferred" in sources and row.get("material_source") != "logged"


def naming_row(rows: Sequence[Mapping[str, object]]) -> Mapping[str, object] | None:
    """Return the row whose label names the file: the longest that is not ``none``.

    Among rows of equal duration, as of two tracks, a person's row is preferred, then the most
    probable.

    Examples
    --------
    >>> short = {"label": "creak", "start_s": 0.0, "end_s": 1.0}
    >>> naming_row([short, {"label": "none", "start_s": 1.0, "end_s": 9.0}])["label"]
    'creak'
    """
    labelled = [row for row in rows if row.get("label") is not None]
    loud = [row for row in labelled if row["label"] != "none"]
    return max(loud or labelled, key=_priority, default=None)


def labels_in(rows: Sequence[Mapping[str, object]]) -> tuple[str, ...]:
    """Return all labels of a recording, by decreasing duration of their longest row.

    ``none`` comes last.

    Examples
    --------
    >>> short = {"label": "creak", "start_s": 0.0, "end_s": 1.0}
    >>> long = {"label": "squeal", "start_s": 1.0, "end_s": 3.0}
    >>> labels_in([{"label": "none", "start_s": 3.0, "end_s": 9.0}, short, long])
    ('squeal', 'creak', 'none')
    """
    longest: dict[str, float] = {}
    for row in rows:
        if row["label"] is not None:
            label = str(row["label"])
            longest[label] = max(_length(row), longest.get(label, 0.0))
    return tuple(sorted(longest, key=lambda label: (label == "none", -longest[label])))


def result_lines(rows: Iterable[Mapping[str, object]]) -> Iterator[str]:
    """Yield one line per file: label, frequency, level, time and probability.

    Parameters
    ----------
    rows : iterable of mapping
        Rows of the label table, grouped by file.

    Yields
    ------
    str
        Text of the segment that names the file and of the longest segment of each other noise, with
        the track if there are several; or the reason of a refusal.

    Examples
    --------
    >>> row = {"file": "run07.wav", "label": "squeal", "start_s": 1.99, "end_s": 6.01,
    ...        "frequency_hz": 974.2, "level_dba": 59.9, "p_squeal": 0.93}
    >>> list(result_lines([row, {"file": "b.wav", "label": None, "error": "is empty"}]))
    ['run07.wav  squeal 974 Hz  59.9 dB(A)  1.99-6.01 s  p 0.93', 'b.wav  refused: is empty']
    >>> list(result_lines([row | {"channel": "2"}]))
    ['run07.wav  squeal 974 Hz  59.9 dB(A)  1.99-6.01 s  p 0.93  track 2']
    """
    for file, of_file in groupby(rows, key=lambda row: row["file"]):
        segments = list(of_file)
        row = naming_row(segments)
        if row is None:
            yield f"{file}  refused: {segments[0].get('error')}"
            continue
        also = ""
        for label in labels_in(segments)[1:]:
            other = naming_row([one for one in segments if one["label"] == label])
            if label in NAMED and other is not None:
                also += f"  also {'  '.join(_result_words(other))}"
        yield f"{file}  {'  '.join(_result_words(row))}{also}"


def _result_words(row: Mapping[str, object]) -> Iterator[str]:
    label, hertz, start, end = (row.get(c) for c in ("label", "frequency_hz", "start_s", "end_s"))
    yield f"{label} {hertz:.0f} Hz" if isinstance(hertz, float) else str(label)
    for column, unit in (("level_dba", "dB(A)"), ("level_dbfs", "dBFS")):
        level = row.get(column)
        if isinstance(level, float):
            loud = " (above full scale)" if unit == "dBFS" and level > 0.0 else ""
            yield f"{level:.1f} {unit}{loud}"
            break
    if isinstance(start, float) and isinstance(end, float):
        yield f"{start:.2f}-{end:.2f} s"
    probability = row.get(f"p_{label}")
    if row.get("label_source") == "human":
        yield "by hand"
    elif isinstance(probability, float):
        # `unknown` may be less probable than a noise below its threshold.
        noises = [(p, name) for name in NAMED if isinstance(p := row.get(f"p_{name}"), float)]
        p, name = max(noises, default=(0.0, ""))
        less = label == "unknown" and p > probability
        yield f"p {probability:.2f}" + (f" ({name} {p:.2f})" if less else "")
    if row.get("channel", "all") != "all":
        yield f"track {row['channel']}"


def _priority(row: Mapping[str, object]) -> tuple[float, bool, float]:
    probability = row.get(f"p_{row['label']}")
    return (
        _length(row),
        row.get("label_source") == "human",
        probability if isinstance(probability, float) else 0.0,
    )


def _length(row: Mapping[str, object]) -> float:
    start, end = row.get("start_s"), row.get("end_s")
    if isinstance(start, int | float) and isinstance(end, int | float):
        return float(end - start)
    return 0.0
