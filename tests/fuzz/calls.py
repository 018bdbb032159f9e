"""What is done with a damaged file: commands as a user calls them, and readers of dear commands.

A call names the valid file that is damaged, how it is called then, what lies beside it, and the
arguments. Where a command would go on for minutes once the file is read (`train`, `identify`,
`screen`), its reader is called alone. None takes more than a few hundredths of a second.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from models.errors import BushingNoiseError
from noise.cli import main
from tests.fuzz import hostile_files as made
from tests.fuzz.mutations import BYTES, JSON, TEXT

if TYPE_CHECKING:
    from collections.abc import Callable

    from tests.fuzz.mutations import Mutation

__all__ = ["CALLS", "Call"]


@dataclass(frozen=True)
class Call:
    """A command, or a reader, on one damaged file.

    Parameters
    ----------
    valid : str
        The file that is damaged, of `write_valid_files`.
    given : str
        What it is called then.
    do : tuple of str, or callable
        Arguments of the command line, with ``GIVEN`` for its path; or what is called with the path.
    mutations : tuple
    beside : mapping of str to str
        Further valid files, by the names that they lie there under.
    share : float
        How often it is tried against the others [-].
    named : bool
        Whether its name may be any.
    """

    valid: str
    given: str
    do: tuple[str, ...] | Callable[[Path], object]
    mutations: tuple[Mutation, ...]
    beside: dict[str, str]
    share: float = 1.0
    named: bool = True

    def run(self, path: Path) -> int:
        """Do it; return the exit code."""
        if isinstance(self.do, tuple):
            return main([part.replace("GIVEN", str(path)) for part in self.do])
        try:
            self.do(path)
        except BushingNoiseError:
            return 1
        return 0


def _sounds() -> dict[str, Call]:
    commands = {
        "features": ("features", "GIVEN"),
        "label": ("label", "GIVEN", "--out", "out.csv"),
        "drawn": ("features", "GIVEN", "--plot", "plots"),
        "render": ("render", "GIVEN", "--out", "out.wav"),
        "review": ("review", ".", "--out", "out.html"),
        "identify": ("identify", "GIVEN"),
        "frf": ("frf", "GIVEN", "--out", "out.npz"),
        "calibrator": ("features", "run.wav", "--calibrator", "GIVEN", "--level", "94"),
        "diagnose": ("diagnose", "GIVEN", "--rig", "rig.toml", "--quick", "--out", "out"),
    }
    shares = {"features": 3.0, "label": 2.0, "drawn": 0.2}
    known = {"run.wav": "float.wav", "rig.toml": "rig.toml"}
    return {
        name: Call(
            "float.wav", "given.wav", do, (*BYTES, *[made.wav] * 6), known, shares.get(name, 0.8)
        )
        for name, do in commands.items()
    }


def _formats() -> dict[str, Call]:
    hostile = {
        "pcm.wav": [made.wav], "pcm.flac": [], "pcm.aiff": [], "vorbis.ogg": [], "layer.mp3": [],
        "logger.h5": [made.hdf5], "logger.mf4": [made.mdf], "logger.tdms": [made.tdms],
        "logger.uff": [made.uff, *TEXT],
    }  # fmt: skip
    return {
        name: Call(
            name, f"given{Path(name).suffix}", ("features", "GIVEN"),
            (*BYTES, *more * max(1, 8 // max(1, len(more)))), {},
            2.0 if name.startswith("logger") else 0.7,
        )
        for name, more in hostile.items()
    }  # fmt: skip


def _tables() -> dict[str, Call]:
    texts = {".csv": TEXT, ".jsonl": JSON, ".parquet": (*BYTES, *[made.parquet] * 8),
             ".xlsx": (*BYTES[:4], *[made.workbook] * 8)}  # fmt: skip
    review = ("review", ".", "--out", "out.html")
    screen = ("review", "GIVEN", "--simulated", "0", "--out", "out.html")
    found = {}
    for ending, mutations in texts.items():
        given, valid = f"given{ending}", f"labels{ending}"
        tracks = ("label", "GIVEN", "--audacity", "out")
        found[f"tracks of {valid}"] = Call(valid, given, tracks, mutations, {}, 0.8)
        beside = {"given.wav": "float.wav"}
        found[f"review of {valid}"] = Call(valid, given, review, mutations, beside, 0.6)
    return found | {
        "map": Call("map.csv", "given.csv", screen, TEXT, {}),
        "numbers": Call("numbers.csv", "given.csv", _numbers, TEXT, {}),
        "own track": Call(
            "track.txt", "given.txt", _own, TEXT, {"given.wav": "float.wav"}, 0.6, named=False
        ),
        "own table": Call("labels.csv", "given.csv", _own, TEXT, {"given.wav": "float.wav"}, 0.6),
        "app": Call("labels.csv", "given.csv", _opened, TEXT, {"given.wav": "float.wav"}, 0.6),
        "journal": Call(
            "labels.csv.journal", ".given.csv.journal", ("label", "run.wav", "--out", "given.csv"),
            (*JSON, *TEXT), {"run.wav": "float.wav"}, 0.5, named=False,
        ),
    }  # fmt: skip


def _rest() -> dict[str, Call]:
    brief = ("--speed", "5", "--seconds", "0.01", "--out", "out.wav")
    rig = ("simulate", "--rig", "GIVEN", *brief)
    response = ("simulate", "--rig", "rig.toml", *brief)
    log = ("simulate", "--speed", "GIVEN", "--seconds", "0.01", "--out", "out.wav")
    arrays = (*BYTES, *[made.npz] * 12)
    hit = ("frf", "GIVEN", "--out", "out.npz")
    run = {"run.wav": "float.wav"}
    return {
        "sidecar": Call(
            "sidecar.json", "given.json", ("features", "given.wav"), JSON,
            {"given.wav": "float.wav"}, 2.0, named=False,
        ),
        "sidecar, labelled": Call(
            "sidecar.json", "given.json", ("label", "given.wav"), JSON,
            {"given.wav": "float.wav"}, 0.8, named=False,
        ),
        "rig": Call("rig.toml", "given.toml", rig, TEXT, {}, 3.0),
        "rig, diagnosed": Call(
            "rig.toml", "given.toml", ("diagnose", "run.wav", "--rig", "GIVEN", "--out", "out"),
            TEXT, run, 0.6,
        ),
        "rig, identified": Call(
            "rig.toml", "given.toml", ("identify", "run.wav", "--rig", "GIVEN"), TEXT, run, 0.6
        ),
        "design": Call("design.toml", "given.toml", _design, TEXT, {}, 2.0),
        "response.csv": Call(
            "response.csv", "given.csv", response, TEXT, {"rig.toml": "rig_csv.toml"}, named=False
        ),
        "response.npz": Call(
            "response.npz", "given.npz", response, arrays, {"rig.toml": "rig_npz.toml"}, named=False
        ),
        "log": Call("log.csv", "given.csv", log, TEXT, {}),
        "effects": Call(
            "effects.py", "given.py",
            ("simulate", "--effects", "GIVEN", "--effect", "zero_offset", *brief), TEXT, {}, 0.5,
        ),
        "diagnosis": Call(
            "diagnosis.json", "diagnosis.json", _reviewed, JSON, {}, 2.0, named=False
        ),
        "report": Call(
            "report.html", "report.html", _reviewed, TEXT, {"diagnosis.json": "diagnosis.json"},
            0.6, named=False,
        ),
        "hit.npy": Call("hit.npy", "given.npy", hit, (*BYTES, *[made.npy] * 12), {}, 1.5),
        "hit.csv": Call("hit.csv", "given.csv", hit, TEXT, {}),
        "classifier": Call(
            "classifier.npz", "given.npz", ("label", "run.wav", "--classifier", "GIVEN"), arrays,
            run, 2.0,
        ),
        "inference": Call(
            "conditions.npz", "given.npz", ("label", "run.wav", "--inference", "GIVEN"), arrays,
            run, 0.5,
        ),
        "samples": Call("samples.npz", "given.npz", _samples, arrays, {}, 0.5),
    }  # fmt: skip


def _reviewed(path: Path) -> None:
    main(["review", str(path.parent), "--out", "out.html"])


def _numbers(path: Path) -> None:
    from noise.identification.table_number import read_numbers

    read_numbers(path)


def _design(path: Path) -> None:
    from noise.screening.design.design import load_design
    from noise.screening.design.design_files import copy_design_file

    copy_design_file(load_design(path).name, path, Path("out"))


def _own(path: Path) -> None:
    from noise.training.classifier.own_recordings import read_labelled

    read_labelled(path.parent)


def _samples(path: Path) -> None:
    from noise.training.classifier.kept_samples import load_samples

    load_samples(path, (0, 1))


def _opened(path: Path) -> None:
    from noise.app.labels import Labels
    from noise.app.opened import open_paths
    from noise.labels.labelling import Labelling

    opened = open_paths([path])
    assert opened.table is not None
    Labels(opened.jobs, opened.table, Labelling())


CALLS = _sounds() | _formats() | _tables() | _rest()
"""By the names that the corpus calls them by."""
