"""Training cases in files: drawn in chunks that can be taken up again, read as one population.

A chunk is one NPZ file, named by its seeds: numbers of all its recordings in single precision, and
a header that says of each case what it is about and of what bench. Other programs may read it.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, astuple
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray

from models.condition import KnownCondition, known_condition
from models.errors import ParameterError
from noise.base.files import atomic, check_target
from noise.diagnosis.cases.draw import SHARED
from noise.diagnosis.cases.truth import Truth
from noise.diagnosis.evidence.summary import CaseTable
from noise.training.causes.build import known_cases_of_a_rig
from noise.training.causes.fit import Known

CHUNK = 40 * SHARED
"""Seeds of a file."""

_PARTS = ("measured", "nominal", "scatter")


def draw_into(folder: Path, seeds: range, workers: int = 1) -> Iterator[Path]:
    """Draw cases into files of a folder; those that are there are left as they are.

    Parameters
    ----------
    folder : Path
    seeds : range
        The first begins a rig.
    workers : int
        Processes.

    Yields
    ------
    Path
        Of each file, as soon as it is there.

    Raises
    ------
    ParameterError
        The folder cannot be written to.
    """
    check_target(folder / "cases", "--out")
    chunks = [seeds[i : i + CHUNK] for i in range(0, len(seeds), CHUNK)]
    yield from Parallel(n_jobs=workers, return_as="generator_unordered")(
        delayed(_draw_chunk)(folder, chunk) for chunk in chunks
    )


def save_cases(path: Path, cases: Sequence[Known]) -> None:
    """Write cases into a file, whole or not at all.

    Parameters
    ----------
    path : Path
    cases : sequence of Known

    Raises
    ------
    ParameterError
        The file cannot be written.
    """
    names = sorted({name for case in cases for name in case.table.names})
    place = {name: i for i, name in enumerate(names)}

    def rows(part: str) -> NDArray[np.float32]:
        filled = [np.zeros((0, len(names)), np.float32)]
        for case in cases:
            table = np.full((len(case.table.conditions), len(names)), np.nan, np.float32)
            table[:, [place[name] for name in case.table.names]] = getattr(case.table, part)
            filled.append(table)
        return np.concatenate(filled)

    header = {"names": names, "cases": [_described(case) for case in cases]}
    text = np.frombuffer(json.dumps(header).encode(), dtype=np.uint8)
    with atomic(path) as passing:
        measured, nominal, scatter = map(rows, _PARTS)
        np.savez_compressed(
            passing, header=text, measured=measured, nominal=nominal, scatter=scatter
        )


def load_cases(folder: Path) -> list[Known]:
    """Read the cases of all files of a folder, in the order of their seeds.

    Parameters
    ----------
    folder : Path

    Returns
    -------
    list of Known
        Of tables in single precision.

    Raises
    ------
    ParameterError
        There are no such files, or one is damaged.
    """
    paths = sorted(folder.glob("cases-*.npz"))
    if not paths:
        raise ParameterError(f"{folder}: no cases-*.npz; draw some first")
    cases = [case for path in paths for case in _read(path)]
    return sorted(cases, key=lambda case: case.seed)


def _draw_chunk(folder: Path, seeds: range) -> Path:
    path = folder / f"cases-{seeds.start}-{seeds.stop}.npz"
    if not path.exists():
        rigs = (seeds[i : i + SHARED] for i in range(0, len(seeds), SHARED))
        save_cases(path, [case for rig in rigs for case in known_cases_of_a_rig(rig)])
    return path


def _read(path: Path) -> list[Known]:
    try:
        with np.load(path) as file:
            header = json.loads(file["header"].tobytes())
            parts = [file[part] for part in _PARTS]
        ends = np.cumsum([len(case["conditions"]) for case in header["cases"]])[:-1]
        tables = zip(*(np.split(part, ends) for part in parts), strict=True)
        return [
            _known(tuple(header["names"]), table, case)
            for table, case in zip(tables, header["cases"], strict=True)
        ]
    except (OSError, ValueError, KeyError, TypeError, EOFError) as error:
        raise ParameterError(f"{path}: no file of drawn cases ({error})") from error


def _described(case: Known) -> dict[str, Any]:
    return {
        "seed": case.seed,
        "rig": case.rig,
        "departures": case.departures,
        "rate": case.table.rate,
        "bench": dict(case.table.bench),
        "truth": asdict(case.truth),
        "conditions": [astuple(known_condition(c)) for c in case.table.conditions],
    }


def _known(names: tuple[str, ...], parts: Sequence[Any], said: dict[str, Any]) -> Known:
    truth = {key: _tuples(value) for key, value in said["truth"].items()}
    conditions = tuple(KnownCondition(*values) for values in said["conditions"])
    measured, nominal, scatter = parts
    return Known(
        CaseTable(
            names, measured, nominal, scatter, conditions, said["rate"], said["bench"]
        ),
        Truth(**truth), said["rig"], tuple(said["departures"]), said["seed"],
    )  # fmt: skip


def _tuples(value: Any) -> Any:
    return tuple(_tuples(one) for one in value) if isinstance(value, list) else value
