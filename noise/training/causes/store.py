"""Training cases in files: drawn in chunks that can be taken up again, read as one population.

A chunk is one NPZ file, named by its seeds: numbers of all its recordings in single precision, and
a header that says of each case what it is about and of what bench. Other programs may read it.

Training cases: drawn, simulated, and each summarised as a user's case would be.

What takes time are simulated repeats of the rig as its file has it. The cases of a rig share them
where they would differ by less than chance: where the noise of sensors was estimated about alike,
and the speeds that the angle tells.
"""

from __future__ import annotations

import json
import math
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import asdict, astuple, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray

from models.condition import KnownCondition, known_condition
from models.errors import BushingNoiseError, ParameterError
from models.recording import Recording
from models.rig import Rig
from models.sensors import Sensors
from noise.base.files import atomic, check_target
from noise.diagnosis.evidence.summary import CaseTable, NominalNumbers, Numbers, case_table
from noise.diagnosis.preparation.prepare import prepared
from noise.training.causes.cases.draw import SHARED, DrawnCase, draw_case
from noise.training.causes.cases.truth import Truth
from noise.training.causes.fit import Known, with_rows
from sim.acquisition import Acquisition

_SAME_NOISE, _SAME_SPEED = 0.2, 8e-3
"""Relative differences up to which estimates are taken for the same."""

_FEWEST = 2
"""Recordings of a case."""


def known_cases_of_a_rig(seeds: Sequence[int]) -> list[Known]:
    """Draw cases of one rig and summarise them; those that cannot be simulated are left out.

    Examples
    --------
    >>> cases = known_cases_of_a_rig([400_000])
    >>> all(case.table.measured.shape == case.table.nominal.shape for case in cases)
    True
    """
    shared: list[_Shared] = []
    known = []
    for seed in seeds:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # a response that ends early says so in each case
                case = draw_case(seed)
                table = _table(case, shared)
        except BushingNoiseError:
            continue
        if table is not None:
            single = with_rows(table, _single)
            known.append(Known(single, case.truth, seed // SHARED, case.departures, seed))
    return known


def _table(case: DrawnCase, shared: list[_Shared]) -> CaseTable | None:
    """Summarise a case as a user's would be, with repeats of earlier ones where these serve."""
    ready = prepared(case.rig, case.recordings)
    if len(ready.recordings) < _FEWEST:
        return None
    repeats = next((s for s in shared if s.serves(ready.rig)), None)
    if repeats is None:
        repeats = _Shared(ready.rig)
        shared.append(repeats)
    return case_table(ready.recordings, repeats.rig, nominal=repeats)


@dataclass(frozen=True, eq=False)
class _Shared(NominalNumbers):
    """Repeats that several cases of a rig share, and the speeds that they were simulated at."""

    speeds: dict[tuple[object, ...], list[float]] = field(default_factory=dict)

    def serves(self, rig: Rig) -> bool:
        """Whether a rig is the same but for estimates that hardly differ."""
        same = replace(rig, sensors=self.rig.sensors) == self.rig
        return same and _alike(self.rig.sensors, rig.sensors)

    def moments(self, recording: Recording) -> tuple[Numbers, Numbers]:
        """Mean and standard deviation of repeats, at a speed that is there if one is near."""
        c = known_condition(recording.condition)
        known = self.speeds.setdefault((c.interference, c.support_stiffness), [])
        near = min(known, key=lambda v: abs(v - c.speed), default=math.inf)
        if abs(near - c.speed) > _SAME_SPEED * abs(c.speed):
            known.append(c.speed)
            near = c.speed
        return super().moments(replace(recording, condition=replace(c, speed=near)))


def _alike(one: Sensors, other: Sensors) -> bool:
    """Whether sensors are the same but for estimates of noise and steps that hardly differ."""
    for kind, usual in Acquisition().noise.items():
        a, b = one.of(kind), other.of(kind)
        if (a.bits, a.antialias) != (b.bits, b.antialias) or not math.isclose(a.step, b.step):
            return False
        levels = [usual if sensor.noise is None else sensor.noise for sensor in (a, b)]
        least = 0.1 * a.step  # less than that is lost in the rounding
        if not math.isclose(*levels, rel_tol=_SAME_NOISE, abs_tol=least):
            return False
    return True


def _single(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Round to single precision: cases stored in half the space are still the same ones."""
    return x.astype(np.float32).astype(np.float64)


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
