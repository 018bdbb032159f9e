"""The review: from paths to one page.

The page goes from the whole to the single sound: maps, diagnoses, recordings. Every refusal is on
it, since whoever looks at it later cannot see the terminal.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from models.errors import BushingNoiseError, ParameterError
from models.show import short_repr
from noise.base.progress import counted
from noise.pages.engine.clips import common_gain, make_clips
from noise.pages.engine.entry import label_counts, labels_sentence
from noise.pages.engine.maps import recorded_maps
from noise.pages.engine.page import CARD_BYTES, ORDERS_BYTES, PAGE_BYTES, page_html, write_page
from noise.pages.review.diagnoses import read_diagnosis
from noise.pages.review.inputs import Refusal, sort_inputs
from noise.pages.review.recorded import recorded_entries
from noise.pages.review.screened import screened_maps

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from noise.pages.engine.entry import Entry
    from noise.pages.review.diagnoses import DiagnosisDisplay
    from noise.pages.review.inputs import Inputs
    from noise.recordings.meaning import PascalPerFullScale

__all__ = ["Review", "review"]

_PAGE = "report.html"


@short_repr
@dataclass(frozen=True)
class Review:
    """A page that was written.

    Parameters
    ----------
    path : Path
    sounds : int
        How many can be played.
    shortened : float or None
        To how many seconds sounds were cut so as to keep to the budget; None where none was.
    refused : tuple of Refusal
        Inputs that could not be used.

    Examples
    --------
    >>> from pathlib import Path
    >>> Review(Path("review/report.html"), 12, None, ()).path.name
    'report.html'
    """

    path: Path
    sounds: int
    shortened: float | None
    refused: tuple[Refusal, ...]


def review(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    out: str | os.PathLike[str] = _PAGE,
    *,
    title: str = "Review",
    full_scale: PascalPerFullScale | None = None,
    pascal_per_full_scale: float | None = None,
    seconds: float = 10.0,
    megabytes: float = 25.0,
    simulated: int = 48,
    classify: bool = True,
    seed: int = 0,
) -> Review:
    """Write a review page: recordings, labels, screens and diagnoses to look at and to listen to.

    Parameters
    ----------
    paths : path-like or iterable of path-like
        Recordings, label tables, maps of a screen (``map.csv``), diagnoses (``diagnosis.json``),
        rig files of a screen's designs (``.toml``), and folders of them at any depth.
    out : path-like
        The page, or a folder for ``report.html``.
    title : str
    full_scale : float or tuple of float, optional
        Sound pressure of a full-scale sample of the recordings [Pa]; wins over what they say.
    pascal_per_full_scale : float, optional
        Of the page, for a listening room that is calibrated to it [Pa]; by default what the
        loudest of all calibrated sounds needs. Either way they have one gain.
    seconds : float
        Longest stretch of a recording that is played [s].
    megabytes : float
        Size of the page [MB]; where it does not hold all, sounds are shortened, and the page says
        so.
    simulated : int
        How many sounds are simulated for the maps of screens, of all maps together.
    classify : bool
        Whether recordings that no table labels are labelled by the classifier that is shipped.
    seed : int
        Of simulated sounds and of the dither.

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
    >>> from models.recording import Channel, Recording
    >>> from noise.recordings import write_recording
    >>> hum = np.sin(2 * np.pi * 100 * np.arange(48000) / 48e3)[np.newaxis]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     run = write_recording(f"{folder}/run07", Recording(hum, 48e3, (Channel("pressure"),)))
    ...     made = review(run, f"{folder}/review.html", classify=False)
    ...     made.sounds, made.shortened, made.refused
    (1, None, ())
    """
    named = [paths] if isinstance(paths, str | os.PathLike) else list(paths)
    inputs = sort_inputs([Path(path) for path in named])
    target = page_path(Path(out))
    refused = list(inputs.refused)
    budget = 1e6 * megabytes
    recorded = recorded_entries(
        inputs, refused, seconds=seconds, full_scale=full_scale, budget=budget, classify=classify
    )
    diagnosed = _diagnosed(inputs, refused)
    compared, heard = screened_maps(inputs, refused, number=simulated, seed=seed)

    entries: dict[str, Entry] = {}
    groups: list[list[str]] = []
    for members in (recorded, *(one.entries for one in diagnosed)):
        groups.append([f"s{len(entries) + 1 + i}" for i in range(len(members))])
        entries |= dict(zip(groups[-1], members, strict=True))
    entries |= heard
    if not (entries or compared or diagnosed):
        raise ParameterError(f"{refused[0].name}: {refused[0].reason}; there is nothing else")
    gain = common_gain(entries.values(), pascal_per_full_scale)
    n_maps = 0 if compared is None else compared.n_maps
    drawn = 0.0 if compared is None else compared.weight
    drawn += ORDERS_BYTES * sum(entry.orders is not None for entry in entries.values())
    beside = PAGE_BYTES + CARD_BYTES * len(entries) + drawn
    clips, shortened = make_clips(
        entries, gain, budget=budget, beside=beside, dither=np.random.default_rng(seed)
    )
    rows = [{**row, "file": key} for key in groups[0] for row in entries[key].rows]
    titles = {key: entry.title for key, entry in entries.items()}
    of_recordings, unplaced = recorded_maps(rows, titles, clips)
    counts = label_counts(recorded)
    html = page_html(
        "review.html.j2",
        entries,
        clips,
        without_card=heard,
        title=title,
        summary=_summary(recorded, diagnosed, n_maps, len(heard)),
        gain=gain.sentences if clips else (),
        shortened=shortened,
        refused=refused,
        recorded=groups[0],
        counts=counts if len(counts) > 1 else [],
        recorded_maps=of_recordings,
        unplaced=unplaced,
        compared=compared,
        diagnoses=list(zip(diagnosed, groups[1:], strict=True)),
    )
    write_page(target, html)
    return Review(target, len(clips), shortened, tuple(refused))


def page_path(out: Path) -> Path:
    """Return the page that ``--out`` names, which may be the folder for it.

    Examples
    --------
    >>> page_path(Path("review")).name, page_path(Path("review.html")).name
    ('report.html', 'review.html')
    """
    return out if out.suffix.lower() in (".html", ".htm") and not out.is_dir() else out / _PAGE


def _diagnosed(inputs: Inputs, refused: list[Refusal]) -> list[DiagnosisDisplay]:
    diagnosed = []
    for path in inputs.diagnoses:
        try:
            diagnosed.append(read_diagnosis(path))
        except BushingNoiseError as error:
            refused.append(Refusal.of(path, error))
    return diagnosed


def _summary(
    recorded: Sequence[Entry], diagnosed: Sequence[DiagnosisDisplay], n_maps: int, n_heard: int
) -> str:
    told = []
    if recorded:
        told.append(labels_sentence(recorded))
    if diagnosed:
        told.append(f"{len(diagnosed)} diagnos{'is' if len(diagnosed) == 1 else 'es'}")
    if n_maps:
        heard = f" with {counted(n_heard, 'simulated sound')}" if n_heard else ""
        told.append(f"{counted(n_maps, 'map')} of a screen{heard}")
    return f"{'; '.join(told)}." if told else ""
