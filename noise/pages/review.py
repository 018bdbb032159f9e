"""Review page: recordings, labels, screens and diagnoses with sounds.

The page shows maps first, then diagnoses and recordings. It lists all refused inputs, because its
readers do not see the terminal.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from models.errors import BushingNoiseError, ParameterError, RecordingError
from models.foreign_file import LARGEST_JSON, parse_json, reading, refusing
from models.rig import Rig
from models.show import short_repr
from noise.base.labels import LABELS, MAP_LABELS, PERSISTS
from noise.base.progress import counted
from noise.base.tables import read_table
from noise.labels.table import cell_number, cell_truth, check_name
from noise.pages import blocks as b
from noise.pages.clips import Entry, common_gain, label_counts, labels_sentence, make_clips
from noise.pages.comparison import Compared, compare_designs
from noise.pages.maps import recorded_maps
from noise.pages.page import (
    CARD_BYTES,
    PAGE_BYTES,
    page_html,
    shortened_text,
    write_page,
)
from noise.pages.review_inputs import Inputs, Refusal, recorded_entries, sort_inputs
from noise.pages.screen_sounds import ScreenMap, ScreenPoint
from noise.recordings.folders import is_file
from noise.recordings.interpretation import PascalPerFullScale
from noise.screening.design import load_design
from noise.screening.environments import DRY, environment, in_environment


def rig_of(screened: ScreenMap, folder: Path, designs: Sequence[Path]) -> Rig:
    """Return the rig of a screened design in its environment.

    Parameters
    ----------
    screened : ScreenMap
    folder : Path
        Folder of the screen.
    designs : sequence of Path
        Design files of the call.

    Raises
    ------
    ParameterError
        The design file is missing or invalid.
    """
    name = screened.design
    files = [path for path in designs if path.stem == name or _named(path) == name]
    beside = (folder / "designs" / f"{name}.toml", folder / f"{name}.toml")
    files += [path for path in beside if is_file(path)]
    surroundings = environment(screened.environment or DRY)
    if files:
        return in_environment(load_design(files[0]).rig, surroundings)
    try:
        return in_environment(load_design(name).rig, surroundings)
    except ParameterError:
        raise ParameterError(
            f"the file of design {name} is not at hand; name {name}.toml beside the screen"
        ) from None


def _named(path: Path) -> str | None:
    try:
        return load_design(path).name
    except BushingNoiseError:
        return None


_NEEDED = ("design", "speed_rad_s", "interference_mm", "label")
_SUPPORT = "support_stiffness_Nm_rad"


def read_screen(path: Path) -> list[ScreenMap]:
    r"""Read the map of a screen.

    Parameters
    ----------
    path : Path
        CSV, JSON Lines or Parquet with at least the columns design, speed_rad_s, interference_mm
        and label; a support stiffness that is empty or ``fixed`` is the bolted clamp.

    Returns
    -------
    list of ScreenMap
        In the order of the table.

    Raises
    ------
    RecordingError
        The file cannot be read, or a value is invalid.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> text = "design,speed_rad_s,interference_mm,label\nold,5,0.279,squawk\nnew,5,0.279,none\n"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "map.csv"
    ...     _ = path.write_text(text)
    ...     [(one.title, one.points[0].words) for one in read_screen(path)]
    [('old', '5 rad/s, 0.279 mm: squawk'), ('new', '5 rad/s, 0.279 mm: none')]
    """
    _, rows = read_table(path)
    with refusing(str(path), "map of a screen", RecordingError):
        return _maps(path, rows)


def _maps(path: Path, rows: Sequence[dict[str, object]]) -> list[ScreenMap]:
    if not rows:
        raise RecordingError(f"{path}: has no rows, so is no map of a screen")
    maps: dict[tuple[str, str, str, float | None, float | None], list[ScreenPoint]] = {}
    for n, row in enumerate(rows, 1):
        where = f"{path}: row {n}"
        named = row if isinstance(row, dict) else {}  # a line of JSON may be anything
        missing = [column for column in _NEEDED if named.get(column) in (None, "")]
        if missing:
            raise RecordingError(f"{where} has no {missing[0]}")
        label = str(row["label"])
        if label not in LABELS:
            raise RecordingError(f"{where} has label {label!r}, expected {', '.join(LABELS)}")
        if row.get("persists") not in (None, "") and cell_truth(row, "persists", where):
            label = PERSISTS
        check_name(row["design"], "design", where)
        number = partial(cell_number, row, where=where)
        key = (
            str(row["design"]),
            str(row.get("environment") or ""),
            str(row.get("motion") or ""),
            number("temperature_C"),
            _support(row, where),
        )
        speed, fit = number("speed_rad_s"), number("interference_mm")
        if speed is None or fit is None:
            raise RecordingError(f"{where}: speed and interference are numbers")
        maps.setdefault(key, []).append(
            ScreenPoint(
                speed, fit, label,
                str(row.get("regime") or ""),
                number("level_dba"),
                str(row.get("how") or ""),
                number("frequency_hz") or None,
                str(row.get("note") or ""),
            )
        )  # fmt: skip
    return [ScreenMap(*key, tuple(points)) for key, points in maps.items()]


def _support(row: dict[str, object], where: str) -> float | None:
    if _SUPPORT not in row:
        return None
    if row[_SUPPORT] in (None, "", "fixed", math.inf):
        return math.inf
    return cell_number(row, _SUPPORT, where)


def read_diagnosis(path: Path) -> b.Section:
    """Return a diagnosis as a section of a page: answer, next measurement, notes.

    Parameters
    ----------
    path : Path
        File ``diagnosis.json``.

    Raises
    ------
    RecordingError
        The file cannot be read or is not a diagnosis.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> from noise.pages.diagnosis import write_diagnosis
    >>> nothing = Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0)
    >>> with tempfile.TemporaryDirectory() as name:
    ...     write_diagnosis(Path(name), nothing)
    ...     read_diagnosis(Path(name) / "diagnosis.json").heading.partition(": ")[2]
    'No gap'
    """
    with reading(path, "diagnosis", error=RecordingError, largest=LARGEST_JSON):
        data = parse_json(path.read_text(encoding="utf-8"))
        if not isinstance(data, dict) or "verdict" not in data or "probabilities" not in data:
            raise RecordingError(f"{path}: has no verdict and probabilities, so is no diagnosis")
        if isinstance(data["verdict"], list) and "sentences" not in data:
            raise RecordingError(f"{path}: is of an earlier version of the program; diagnose again")
        head, following = str(data["headline"]), str(data["next_measurement"])
        sentences, notes = ([str(one) for one in data[key]] for key in ("sentences", "notes"))
        return b.Section(
            f"Diagnosis {path.parent.resolve().name}: {head}",
            [
                *(b.Text(sentence) for sentence in sentences),
                b.Text(following, "next", "To measure next:"),
                b.Items(notes, "soft"),
                b.Text("Sounds and figures: report.html beside diagnosis.json.", "soft small"),
            ],
            "diagnosis",
        )


def screened_maps(
    inputs: Inputs, refused: list[Refusal], *, number: int, seed: int
) -> tuple[Compared | None, dict[str, Entry]]:
    """Lay out the maps of screens, and simulate their sounds.

    Parameters
    ----------
    inputs : Inputs
    refused : list of Refusal
        Extended by unreadable inputs.
    number : int
        Of sounds, of all maps together.
    seed : int

    Returns
    -------
    compared : Compared or None
        None where there is no screen.
    heard : dict of str to Entry
        Sounds by id.
    """
    maps: list[ScreenMap] = []
    rigs: list[Rig | str] = []
    for path in inputs.screens:
        try:
            of_file = read_screen(path)
        except BushingNoiseError as error:
            refused.append(Refusal.of(path, error))
            continue
        rigs += [_rig(one, path.parent, inputs.designs) for one in of_file]
        if {one.title for one in maps} & {one.title for one in of_file}:
            of_file = [replace(one, design=f"{one.design}, {path.parent.name}") for one in of_file]
        maps += of_file
    if not maps:
        return None, {}
    return compare_designs(maps, rigs, number=number, seed=seed)


def _rig(screened: ScreenMap, folder: Path, designs: Sequence[Path]) -> Rig | str:
    """Return the rig of a map, or the reason why it has no sound."""
    try:
        return rig_of(screened, folder, designs)
    except BushingNoiseError as error:
        return str(error)


_PAGE = "report.html"


@short_repr
@dataclass(frozen=True)
class Review:
    """Result of a written review.

    Parameters
    ----------
    path : Path
    sounds : int
        Number of playable sounds.
    shortened : float or None
        Duration of shortened sounds [s]; None if none was shortened.
    refused : tuple of Refusal
        Refused inputs.

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
    """Write a review page of recordings, labels, screens and diagnoses with sounds.

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
    compared, simulated_sounds = screened_maps(inputs, refused, number=simulated, seed=seed)

    keys = [f"s{number + 1}" for number in range(len(recorded))]
    entries = dict(zip(keys, recorded, strict=True)) | simulated_sounds
    if not (entries or compared or diagnosed):
        raise ParameterError(f"{refused[0].name}: {refused[0].reason}; there is nothing else")
    gain = common_gain(entries.values(), pascal_per_full_scale)
    n_maps = 0 if compared is None else compared.n_maps
    drawn = 0.0 if compared is None else compared.weight
    beside = PAGE_BYTES + CARD_BYTES * len(entries) + drawn
    clips, shortened = make_clips(
        entries, gain, budget=budget, beside=beside, dither=np.random.default_rng(seed)
    )
    rows = [{**row, "file": key} for key in keys for row in entries[key].rows]
    titles = {key: entry.title for key, entry in entries.items()}
    of_recordings, unplaced = recorded_maps(rows, titles, clips)
    counts = label_counts(recorded)
    left_out = f"Not on a map, without a logged speed and interference: {unplaced}."
    summary = _summary(recorded, diagnosed, n_maps, len(simulated_sounds))
    html = page_html(
        "review",
        title,
        [
            b.Text(summary, "summary"),
            b.Sounds(gain.sentences if clips else (), LABELS if compared is None else MAP_LABELS),
            shortened_text(shortened),
        ],
        [
            b.Section(
                "Not on this page",
                [b.Items([(one.name, one.reason) for one in refused])],
                "refused",
            ),
            b.Section("What the screen expects", [b.Other("designs", compared)]),
            b.Section(
                "Which noise at which condition",
                [
                    b.Maps(of_recordings),
                    b.Text(left_out if of_recordings and unplaced else "", "note"),
                ],
            ),
            *diagnosed,
            b.Section(
                "Recordings",
                [b.Cards(keys, counts=counts if len(counts) > 1 else [])],
                "recordings",
            ),
        ],
        entries=entries,
        clips=clips,
        without_card=simulated_sounds,
    )
    write_page(target, html)
    return Review(target, len(clips), shortened, tuple(refused))


def page_path(out: Path) -> Path:
    """Return the path of the page; ``--out`` may name its folder.

    Examples
    --------
    >>> page_path(Path("review")).name, page_path(Path("review.html")).name
    ('report.html', 'review.html')
    """
    return out if out.suffix.lower() in (".html", ".htm") and not out.is_dir() else out / _PAGE


def _diagnosed(inputs: Inputs, refused: list[Refusal]) -> list[b.Section]:
    diagnosed = []
    for path in inputs.diagnoses:
        try:
            diagnosed.append(read_diagnosis(path))
        except BushingNoiseError as error:
            refused.append(Refusal.of(path, error))
    return diagnosed


def _summary(
    recorded: Sequence[Entry], diagnosed: Sequence[b.Section], n_maps: int, n_sounds: int
) -> str:
    parts = []
    if recorded:
        parts.append(labels_sentence(recorded))
    if diagnosed:
        parts.append(f"{len(diagnosed)} diagnos{'is' if len(diagnosed) == 1 else 'es'}")
    if n_maps:
        sounds = f" with {counted(n_sounds, 'simulated sound')}" if n_sounds else ""
        parts.append(f"{counted(n_maps, 'map')} of a screen{sounds}")
    return f"{'; '.join(parts)}." if parts else ""
