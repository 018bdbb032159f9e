"""Training cases: drawn, simulated, summarised like the cases of users, and stored in files.

A file holds the cases of a range of seeds as joblib keeps Python objects: reading it runs what it
says, so only files of one's own are read.

What takes time are simulated repeats of the rig as its file has it. The cases of a rig share them
where they would differ by less than chance: where the noise of sensors was estimated about alike,
and the speeds that the angle tells.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from pickle import UnpicklingError

import joblib
import numpy as np

from models.condition import known_condition
from models.errors import BushingNoiseError, ParameterError
from models.recording import Recording
from models.rig import Rig
from models.sensors import Sensors
from noise.base.arrays import Array
from noise.base.files import atomic, check_target
from noise.diagnosis.evidence.summary import CaseTable, NominalNumbers, Numbers, case_table
from noise.diagnosis.preparation.prepare import prepared
from noise.training.causes.cases.draw import SHARED, DrawnCase, draw_case
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
    """Return the table of a case, with the repeats of earlier cases where these apply."""
    rig, recordings, _, _ = prepared(case.rig, case.recordings)
    if len(recordings) < _FEWEST:
        return None
    repeats = next((s for s in shared if s.serves(rig)), None)
    if repeats is None:
        repeats = _Shared(rig)
        shared.append(repeats)
    return case_table(recordings, repeats.rig, nominal=repeats)


@dataclass(frozen=True, eq=False)
class _Shared(NominalNumbers):
    """Repeats shared by several cases of a rig, and their speeds."""

    speeds: dict[tuple[object, ...], list[float]] = field(default_factory=dict)

    def serves(self, rig: Rig) -> bool:
        """Return whether a rig agrees but for small differences of estimates."""
        same = replace(rig, sensors=self.rig.sensors) == self.rig
        return same and _alike(self.rig.sensors, rig.sensors)

    def moments(self, recording: Recording) -> tuple[Numbers, Numbers]:
        """Return mean and standard deviation of repeats, at a stored speed if one is near."""
        c = known_condition(recording.condition)
        known = self.speeds.setdefault((c.interference, c.support_stiffness), [])
        near = min(known, key=lambda v: abs(v - c.speed), default=math.inf)
        if abs(near - c.speed) > _SAME_SPEED * abs(c.speed):
            known.append(c.speed)
            near = c.speed
        return super().moments(replace(recording, condition=replace(c, speed=near)))


def _alike(one: Sensors, other: Sensors) -> bool:
    """Return whether sensors agree but for small differences of estimated noise and steps."""
    for kind, usual in Acquisition().noise.items():
        a, b = one.of(kind), other.of(kind)
        if (a.bits, a.antialias) != (b.bits, b.antialias) or not math.isclose(a.step, b.step):
            return False
        levels = [usual if sensor.noise is None else sensor.noise for sensor in (a, b)]
        least = 0.1 * a.step  # less than that is lost in the rounding
        if not math.isclose(*levels, rel_tol=_SAME_NOISE, abs_tol=least):
            return False
    return True


def _single(x: Array) -> Array:
    """Round to single precision, which halves the files and leaves the cases equal."""
    return x.astype(np.float32).astype(np.float64)


CHUNK = 40 * SHARED
"""Seeds of a file."""


def draw_into(folder: Path, seeds: range, workers: int = 1) -> Iterator[Path]:
    """Draw cases into files of a folder.

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
    yield from joblib.Parallel(n_jobs=workers, return_as="generator_unordered")(
        joblib.delayed(_draw_chunk)(folder, chunk) for chunk in chunks
    )


def _draw_chunk(folder: Path, seeds: range) -> Path:
    path = folder / f"cases-{seeds.start}-{seeds.stop}.joblib"
    rigs = (seeds[i : i + SHARED] for i in range(0, len(seeds), SHARED))
    cases = [case for rig in rigs for case in known_cases_of_a_rig(rig)]
    with atomic(path) as passing:
        joblib.dump(cases, passing, compress=3)
    return path


def load_cases(folder: Path) -> list[Known]:
    """Read the cases of all files of a folder, in the order of their seeds.

    Raises
    ------
    ParameterError
        There are no such files, or one is damaged.
    """
    paths = sorted(folder.glob("cases-*.joblib"))
    if not paths:
        raise ParameterError(f"{folder}: no cases-*.joblib; draw some first")
    try:
        cases = [case for path in paths for case in joblib.load(path)]
    except (OSError, ValueError, EOFError, LookupError, AttributeError, UnpicklingError) as error:
        raise ParameterError(f"{folder}: a file of drawn cases is damaged ({error})") from error
    return sorted(cases, key=lambda case: case.seed)
