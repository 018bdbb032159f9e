"""Review page: recordings and their labels, with sounds.

A file is taken at its word and refused where it is not what its ending says. A folder is searched:
what in it is neither a recording nor a label table is passed over. Refusals are collected, for a
review that lacks one bad file is better than none; the page lists them, because its readers do not
see the terminal. A recording is cut as it is read: a campaign may be larger than memory.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from models.errors import BushingNoiseError, ParameterError
from models.recording import Recording, RecordingBlocks
from models.show import short_repr
from noise.audio.sound import LOWEST_AUDIBLE_RATE, audible
from noise.base.progress import readable, track
from noise.base.tables import TABLE_ENDINGS, table_columns
from noise.classifier import Classifier, load_classifier
from noise.labels.rows import label_rows
from noise.labels.segments import label_recording
from noise.labels.summary import naming_row
from noise.labels.table import read_label_table, table_recordings
from noise.pages import blocks as b
from noise.pages.clips import (
    BYTES_A_SECOND,
    Entry,
    Row,
    common_gain,
    label_counts,
    labels_sentence,
    make_clips,
    number_or,
)
from noise.pages.page import page_html, write_page
from noise.recordings import find_recordings
from noise.recordings.files import files_below, open_blocks
from noise.recordings.formats import formats

PAGE = "report.html"
"""Name of the page in a folder."""

_PAGE_BYTES, _CARD_BYTES = 75_000.0, 45_000.0
"""Size of an empty page, and maximum size per sound without its samples [byte]."""

_SHORTEST = 1.0
"""Minimum duration of an excerpt [s]."""


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
        >>> Refusal.of(Path("run07.wav"), "run07.wav: is empty").reason
        'is empty'
        """
        return cls(readable(str(path)), readable(str(error).removeprefix(f"{path}: ")))


@short_repr
@dataclass(frozen=True)
class Review:
    """Result of a written review.

    Parameters
    ----------
    path : Path
    sounds : int
        Number of playable sounds.
    longest : float
        Limit of excerpts that the size of the page sets, as far as it cuts one [s].
    refused : tuple of Refusal
        Refused inputs.

    Examples
    --------
    >>> from pathlib import Path
    >>> Review(Path("review/report.html"), 12, 10.0, ()).path.name
    'report.html'
    """

    path: Path
    sounds: int
    longest: float
    refused: tuple[Refusal, ...]


def review(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    out: str | os.PathLike[str] = PAGE,
    *,
    title: str = "Review",
    full_scale: float | None = None,
    seconds: float = 10.0,
    megabytes: float = 40.0,
    classify: bool = True,
) -> Review:
    """Write a review page of recordings and labels with sounds.

    Parameters
    ----------
    paths : path-like or iterable of path-like
        Recordings, label tables, and folders of them at any depth. With tables alone, the
        recordings below the folder of the first.
    out : path-like
        The page, or a folder for ``report.html``.
    title : str
    full_scale : float, optional
        Sound pressure of a full-scale sample of the recordings [Pa]; wins over what they say.
    seconds : float
        Longest stretch of a recording that is played [s].
    megabytes : float
        Largest size of the page [MB]; of many recordings shorter stretches are played.
    classify : bool
        Whether recordings that no table labels are labelled by the classifier that is shipped.

    Returns
    -------
    Review

    Raises
    ------
    ParameterError
        A path does not exist, there is nothing to review, nothing of it can be used, the page
        cannot be written, or the sounds do not fit into it.

    Examples
    --------
    >>> import tempfile
    >>> from models.recording import Channel
    >>> from noise.recordings import write_recording
    >>> hum = np.sin(2 * np.pi * 100 * np.arange(48000) / 48e3)[np.newaxis]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     run = write_recording(f"{folder}/run07", Recording(hum, 48e3, (Channel("pressure"),)))
    ...     made = review(run, f"{folder}/review.html", classify=False)
    ...     made.sounds, made.longest, made.refused
    (1, 10.0, ())
    """
    named = [paths] if isinstance(paths, str | os.PathLike) else list(paths)
    recordings, table_paths = _inputs([Path(path) for path in named])
    tables, refused = _read_tables(table_paths)
    if not recordings and not refused:
        raise ParameterError(f"{', '.join(map(str, named))}: there are no recordings")
    n = max(1, len(recordings))
    longest = (1e6 * megabytes - _PAGE_BYTES - n * _CARD_BYTES) / (n * BYTES_A_SECOND)
    if longest < _SHORTEST:
        least = _PAGE_BYTES + n * (_CARD_BYTES + _SHORTEST * BYTES_A_SECOND)
        raise ParameterError(
            f"{n} sounds of {_SHORTEST:g} s each do not fit into {megabytes:g} MB; they need "
            f"{1e-6 * least:.1f} MB; allow more, or name fewer"
        )
    longest = min(seconds, longest)
    labelled = _labelled([path for path, _ in recordings], tables)
    needs = any(all(row["label"] is None for row in rows) for rows in labelled)
    classifier = load_classifier() if classify and needs else None
    entries: dict[str, Entry] = {}
    work = list(zip(recordings, labelled, strict=True))
    for (path, name), rows in track(work, "reading"):
        entry = _read_entry(path, name, rows, classifier, longest, full_scale)
        if isinstance(entry, Refusal):
            refused.append(entry)
        else:
            entries[f"s{len(entries) + 1}"] = entry
    if not entries:
        raise ParameterError(f"{refused[0].name}: {refused[0].reason}; there is nothing else")
    gain = common_gain(entries.values())
    clips = make_clips(entries, gain)
    counts = label_counts(entries.values())
    refusals = b.Items([(one.name, one.reason) for one in refused])
    html = page_html(
        "review",
        title,
        [
            b.Text(f"{labels_sentence(list(entries.values()))}.", "summary"),
            b.Sounds(gain.sentences if clips else ()),
        ],
        [
            b.Section("Not on this page", [refusals], "refused"),
            b.Section(
                "Recordings",
                [b.Cards(list(entries), counts=counts if len(counts) > 1 else [])],
                "recordings",
            ),
        ],
        entries=entries,
        clips=clips,
    )
    target = page_path(Path(out))
    write_page(target, html)
    cut = any(entry.duration > longest for entry in entries.values())
    return Review(target, len(clips), longest if cut else seconds, tuple(refused))


def page_path(out: Path) -> Path:
    """Return the path of the page; ``--out`` may name its folder.

    Examples
    --------
    >>> page_path(Path("review")).name, page_path(Path("review.html")).name
    ('report.html', 'review.html')
    """
    return out if out.suffix.lower() in (".html", ".htm") and not out.is_dir() else out / PAGE


def _inputs(paths: Sequence[Path]) -> tuple[list[tuple[Path, str]], list[Path]]:
    """Return recordings with unique names, and label tables, each once."""
    recordings: dict[Path, tuple[Path, str]] = {}
    tables: dict[Path, Path] = {}
    only_tables = True
    for path in paths:
        files = find_recordings(path)  # complains of what is not there
        if path.is_dir():
            only_tables = False
            recordings |= {file.resolve(): (file, name) for file, name in files}
            for file, _ in files_below(path):
                if file.suffix.lower() in TABLE_ENDINGS and table_columns(file) >= {
                    "file",
                    "label",
                }:
                    tables.setdefault(file.resolve(), file)
        elif path.suffix.lower() in TABLE_ENDINGS:
            tables.setdefault(path.resolve(), path)
        elif not _is_sidecar(path):
            only_tables = False
            recordings.setdefault(path.resolve(), files[0])
    if only_tables and tables:
        files = find_recordings(next(iter(tables.values())).absolute().parent)
        recordings = {file.resolve(): (file, name) for file, name in files}
    counts = Counter(name for _, name in recordings.values())
    return [
        (path, name if counts[name] == 1 else readable(str(path)))
        for path, name in recordings.values()
    ], list(tables.values())


def _is_sidecar(path: Path) -> bool:
    """Whether a file is the sidecar of a recording."""
    is_json = path.suffix.lower() == ".json"
    return is_json and any(path.with_suffix(ending).is_file() for ending in formats())


def _read_tables(paths: Iterable[Path]) -> tuple[dict[Path, list[Row]], list[Refusal]]:
    tables: dict[Path, list[Row]] = {}
    refused = []
    for path in paths:
        lines: list[str] = []
        try:
            tables[path] = [*read_label_table(path, lines)]
        except BushingNoiseError as error:
            lines.append(str(error))
        refused += [Refusal.of(path, line) for line in lines]
    return tables, refused


def _labelled(
    recordings: Sequence[Path], tables: Mapping[Path, Sequence[Row]]
) -> list[tuple[Row, ...]]:
    """Return the rows of each recording, of the first table that has some."""
    of_recording: dict[Path, tuple[Row, ...]] = {}
    for table, rows in tables.items():
        of_file = table_recordings((str(row["file"]) for row in rows), table, recordings)
        for path in {
            path for path in of_file.values() if path is not None and path not in of_recording
        }:
            of_recording[path] = tuple(row for row in rows if of_file[str(row["file"])] == path)
    return [of_recording.get(path, ()) for path in recordings]


def _read_entry(
    path: Path,
    name: str,
    rows: Sequence[Row],
    classifier: Classifier | None,
    longest: float,
    full_scale: float | None,
) -> Entry | Refusal:
    """Read the entry of a recording: its labels, and an excerpt of at most `longest` seconds."""
    try:
        with open_blocks(path, full_scale=full_scale) as blocks:
            notes = []
            if any(row["label"] is not None for row in rows):
                notes.append("labelled by the table")
            elif classifier is not None:
                notes.append("labelled for this page")
                rows = label_rows(name, blocks, label_recording(blocks, classifier))
            duration = blocks.n_samples / blocks.rate
            offset = stretch_start(rows, duration, longest)
            excerpt, why = _excerpt(blocks, offset, longest)
            notes += [why] * bool(why)
            sound = None if excerpt is None else audible(excerpt).astype(np.float32)
    except BushingNoiseError as error:
        return Refusal.of(path, error)
    except OSError as error:  # it was there when the folder was searched
        return Refusal.of(path, f"cannot be read ({error.strerror or error})")
    return Entry(
        name, tuple(rows), blocks.condition, duration, sound, offset, blocks.calibrated,
        "; ".join(notes),
    )  # fmt: skip


def stretch_start(rows: Sequence[Row], duration: float, length: float) -> float:
    """Return the start of an excerpt that shows the naming segment of a recording [s].

    Examples
    --------
    >>> rows = [{"label": "squeal", "start_s": 40.0, "end_s": 42.0}]
    >>> stretch_start(rows, 60.0, 10.0), stretch_start([], 60.0, 10.0)
    (36.0, 0.0)
    """
    row = naming_row(rows)
    if row is None or length >= duration:
        return 0.0
    start, end = number_or(row.get("start_s"), 0.0), number_or(row.get("end_s"), duration)
    wanted = start if end - start >= length else 0.5 * (start + end - length)
    return float(min(max(wanted, 0.0), duration - length))


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
