"""Local cases: the rig of the recordings, simulated at their conditions with causes that are known.

What the cause posterior says of a rig that it never saw depends on that rig: two effects that look
alike on one are far apart on another. So the very rig file is run at the very conditions, lengths
and rates of the recordings, and through their sensors, with each cause that is in question; what
the posterior says of these cases tells how to read what it says of the recordings.

Local cases kept on disk, so that a second diagnosis of a rig starts from the first.

One small file holds what the posterior says of the cases of one rig at its conditions; its name is
a digest of all that decides that: rig, runs, posterior, and the version of results. What cannot be
read is made again, what cannot be written is not kept, and the oldest files go.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from platformdirs import user_cache_path

from models.condition import KnownCondition, known_condition
from models.errors import ParameterError
from models.radiation.impulse_responses import ImpulseResponses
from models.recording import Recording
from models.rig import Rig
from noise.base.model_file import ModelKind, load_model, save_model
from noise.base.processes import ending_with_this
from noise.diagnosis.cases.draw import active_effect, draw_offsets, unknown_effect
from noise.diagnosis.cases.rigs import OFFSETS, with_offsets
from noise.diagnosis.cases.structures import draw_structure
from noise.diagnosis.cases.unknown_effects import UNKNOWN_EFFECTS
from noise.diagnosis.cases.variants.common import log_uniform
from noise.diagnosis.evidence.summary import CaseTable, case_table, summary
from noise.diagnosis.simulated.repeats import Scatter, record, run_signals
from noise.diagnosis.simulated.transfer_functions import TransferFunctionCache, chain_of
from sim.bushing import lumped_bushing
from sim.effects import EFFECTS
from sim.effects.effect import ActiveEffect, Effect, activated
from sim.timing import LEARNING

if TYPE_CHECKING:
    from noise.diagnosis.causes.posterior import Posterior

    Known = dict[tuple[frozenset[str], int], NDArray[np.float64]]
    from noise.diagnosis.case import Case

    Job = tuple[frozenset[str], int]

_KIND = ModelKind("local cases", 1, "bushing-noise diagnose", ("", ""))

_MOST = 200
"""Files that are kept; one takes a few ten kilobytes."""


@dataclass(frozen=True)
class LocalCache:
    """File of the local cases of a rig.

    Parameters
    ----------
    path : Path
    """

    path: Path

    @classmethod
    def of(cls, decisive: tuple[object, ...], posterior: Posterior) -> LocalCache | None:
        """Return the file of what is decided by these; None where there is no folder for it.

        Parameters
        ----------
        decisive : tuple
            Whatever the cases depend on beside the program and the posterior.
        posterior : Posterior
        """
        from joblib import hash as digest

        from noise.batch.journal import RESULTS_VERSION

        learned = (posterior.names, posterior.scale, posterior.columns, posterior.trees.arrays())
        with suppress(RuntimeError, OSError):  # a user without a home
            name = digest((RESULTS_VERSION, decisive, learned))
            return cls(_folder() / f"{name}.npz")
        return None

    def read(self) -> Known:
        """Log-odds of each case by cause and number; empty where nothing can be read."""
        try:
            return load_model(self.path, _KIND, _built)
        except ParameterError:
            return {}

    def write(self, known: Mapping[tuple[frozenset[str], int], NDArray[np.float64]]) -> None:
        """Keep cases; without effect where the folder cannot be written.

        Parameters
        ----------
        known : mapping of (frozenset of str, int) to ndarray, shape (n_causes,)
            Natural logarithms of odds of each case by cause and number [-].
        """
        header = {"cases": [[sorted(hypothesis), number] for hypothesis, number in known]}
        arrays = {f"odds{i}": odds for i, odds in enumerate(known.values())}
        with suppress(ParameterError, OSError):
            save_model(self.path, _KIND, header, arrays)
            kept = sorted(self.path.parent.glob("*.npz"), key=lambda path: path.stat().st_mtime)
            for old in kept[:-_MOST]:
                old.unlink(missing_ok=True)


def _built(header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> Known:
    return {
        (frozenset(causes), int(number)): np.asarray(arrays[f"odds{i}"], np.float64)
        for i, (causes, number) in enumerate(header["cases"])
    }


def _folder() -> Path:
    """Return the user's folder for what can be made again."""
    return user_cache_path("bushing-noise", appauthor=False) / "local-cases"


LONGEST = 1.0
"""Of the end of a recording that is looked at [s]: as much has to be simulated many times;
assumed."""

MOST = 6
"""Recordings that are looked at, spread over all there are: how long it takes is to be known;
assumed."""

WEAKEST = 0.1
"""Least strength of an effect: weaker ones are mostly not seen, and so tell nothing; assumed."""

_INACCURACY = 0.003
"""Relative standard deviation of the rig file's own numbers; assumed."""

_OWN_STRENGTHS = (0.3, 10.0)
"""Of a user's own effect, over its default; assumed."""

_OWN_SPREAD = 0.3
"""Of the logarithm of the other numbers of a user's own effect, about their defaults; assumed."""

_NOISE_STEP = 1.25
"""Of a rig's estimated noise, so that it is the same for recordings of about the same noise;
assumed."""

_SEVERAL = 16
"""Cases from which a second process is worth its start."""

_AT_ONCE = 4
"""Cases that a process makes before it hands them over: what a rig's ways take to compute is spread
over them, and what is lost when it is killed is no more."""


@dataclass(frozen=True)
class Run:
    """How a recording was made.

    Parameters
    ----------
    condition : KnownCondition
    rate, seconds : float
        [Hz], [s]
    kinds : tuple of str
        Of its channels.
    """

    condition: KnownCondition
    rate: float
    seconds: float
    kinds: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Bench:
    """A rig, runs that were recorded of it, and what the rig file predicts of them.

    Parameters
    ----------
    rig : Rig
    runs : tuple of Run
    table : CaseTable
        Of these recordings, no longer than `LONGEST`.
    """

    rig: Rig
    runs: tuple[Run, ...]
    table: CaseTable


@dataclass(frozen=True, eq=False)
class LocalCase:
    """What the posterior says of a case whose cause is known.

    Parameters
    ----------
    hypothesis : frozenset of str
        The cause, as of `noise.diagnosis.causes.hypotheses`.
    odds : ndarray, shape (n_causes,)
        Natural logarithms of odds of `CAUSES` [-].
    """

    hypothesis: frozenset[str]
    odds: NDArray[np.float64]


def bench_of(
    case: Case, table: CaseTable, *, library: Mapping[str, Effect] = EFFECTS, seed: int = 0
) -> Bench:
    """Describe how a case was recorded, by `MOST` of its recordings and `LONGEST` of each.

    Parameters
    ----------
    case : Case
    table : CaseTable
        Of its recordings.
    library : mapping of str to Effect
        Effects that the rig's can be found among.
    seed : int
        Of simulated repeats, where the table has to be made again.
    """
    n = len(case.recordings)
    looked = np.unique(np.linspace(0, n - 1, min(n, MOST)).round().astype(int))
    cut = tuple(_cut(case.recordings[i]) for i in looked)
    if len(cut) < n or any(a is not b for a, b in zip(cut, case.recordings, strict=True)):
        table = case_table(cut, case.rig, library=library, seed=seed)
    runs = tuple(
        Run(
            known_condition(r.condition), r.rate, r.duration,
            tuple(channel.kind for channel in r.channels),
        )
        for r in cut
    )  # fmt: skip
    return Bench(case.rig, runs, table)


def local_cases(
    bench: Bench,
    posterior: Posterior,
    wanted: Sequence[Job],
    *,
    library: Mapping[str, Effect] = EFFECTS,
    workers: int = 1,
    seed: int = 0,
) -> list[LocalCase]:
    """Simulate cases of a rig, or take those that an earlier diagnosis of it has kept.

    Parameters
    ----------
    bench : Bench
    posterior : Posterior
    wanted : sequence of (frozenset of str, int)
        Cause and number of each case, in the order in which they are made.
    library : mapping of str to Effect
        Users' own effects among them; cases with one are never kept, since nothing tells whether
        its code has changed.
    workers : int
        Processes.
    seed : int

    Returns
    -------
    list of LocalCase
        In the order wanted, without those that cannot be simulated.
    """
    bench = replace(bench, rig=_rounded(bench.rig))
    shipped = all(EFFECTS.get(spec.name) is library.get(spec.name) for spec in bench.rig.effects)
    cache = LocalCache.of((bench.rig, bench.runs, WEAKEST, seed), posterior) if shipped else None
    known = cache.read() if cache is not None else {}
    n_cached = len(known)
    plain = [job for job in wanted if all(EFFECTS.get(c) is library.get(c) for c in job[0])]
    # A user's code may not be known to another process; it may be slow as well.
    own = [job for job in wanted if job not in plain]
    of_users = dict(_simulated(bench, posterior, own, library, seed))
    missing = [job for job in plain if job not in known]
    if workers > 1 and len(missing) >= _SEVERAL and shipped:
        made = _simulated_by(workers, bench, posterior, missing, seed)
    else:
        made = _simulated(bench, posterior, missing, library, seed)
    known |= dict(made)
    if cache is not None and len(known) > n_cached:
        cache.write(known)
    known |= of_users
    return [LocalCase(job[0], known[job]) for job in wanted if job in known and known[job].size]


def _simulated_by(
    workers: int, bench: Bench, posterior: Posterior, jobs: Sequence[Job], seed: int
) -> Iterator[tuple[Job, NDArray[np.float64]]]:
    """Divide cases between processes; where these are ended, this one makes them."""
    from concurrent.futures.process import BrokenProcessPool

    from joblib import Parallel, delayed

    left = dict.fromkeys(jobs)
    make = delayed(ending_with_this(_listed))
    try:
        for part in Parallel(n_jobs=workers, return_as="generator")(
            make(bench, posterior, jobs[i : i + _AT_ONCE], EFFECTS, seed)
            for i in range(0, len(jobs), _AT_ONCE)
        ):
            for job, odds in part:
                del left[job]
                yield job, odds
    except BrokenProcessPool:
        yield from _simulated(bench, posterior, list(left), EFFECTS, seed)


def _listed(
    bench: Bench,
    posterior: Posterior,
    jobs: Sequence[Job],
    library: Mapping[str, Effect],
    seed: int,
) -> list[tuple[Job, NDArray[np.float64]]]:
    return list(_simulated(bench, posterior, jobs, library, seed))


def _simulated(
    bench: Bench,
    posterior: Posterior,
    jobs: Sequence[Job],
    library: Mapping[str, Effect],
    seed: int,
) -> Iterator[tuple[Job, NDArray[np.float64]]]:
    """Log-odds of each case, as soon as they are there; empty ones of what cannot be simulated."""
    paths = _Paths(bench.rig, library)
    for job in jobs:
        hypothesis, number = job
        key = zlib.crc32("+".join(sorted(hypothesis)).encode())
        rng = np.random.default_rng([seed, key, number])
        try:
            table = _table(bench, hypothesis, paths, library, rng)
        except ParameterError:
            yield job, np.zeros(0)
        else:
            yield job, posterior.log_odds(table)


class _Paths:
    """Ways from torque to acceleration and sound of a rig, each computed once."""

    def __init__(self, rig: Rig, library: Mapping[str, Effect]) -> None:
        self.transfer_functions = TransferFunctionCache(rig, library)
        self._rig = rig
        self._known: dict[tuple[float, float, float], ImpulseResponses] = {}

    def of(self, run: Run) -> ImpulseResponses:
        """Return the impulse responses at the condition and rate of a run."""
        at = (run.condition.interference, run.condition.support_stiffness)
        rate = LEARNING.rate(run.rate)
        if (*at, rate) not in self._known:
            paths = chain_of(self._rig, *at, self.transfer_functions.at(*at), rate, impacts=True)
            self._known[*at, rate] = self._struck(paths, at)
        return self._known[*at, rate]

    def _struck(self, paths: ImpulseResponses, at: tuple[float, float]) -> ImpulseResponses:
        """Have pulses heard where the model of the rig has no way for them: its clamp is bolted."""
        if paths.pulse_to_acceleration.any():
            return paths
        rng = np.random.default_rng(0)
        drawn = draw_structure(lumped_bushing(self._rig, *at), rng).response(paths.rate)
        return replace(
            paths, pulse_to_acceleration=drawn.pulse_to_acceleration,
            pulse_to_pressure=drawn.pulse_to_pressure,
        )  # fmt: skip


def _table(
    bench: Bench,
    hypothesis: frozenset[str],
    paths: _Paths,
    library: Mapping[str, Effect],
    rng: np.random.Generator,
) -> CaseTable:
    """Simulate a case and summarise it against what the rig file predicts."""
    offsets = {name: float(np.exp(_INACCURACY * rng.standard_normal())) for name in OFFSETS}
    if hypothesis == {"parameters"}:
        offsets |= dict(draw_offsets(rng))
    effects = _effects(bench, hypothesis, library, rng)
    replaced = {active.effect.name for active in effects}
    listed = tuple(spec for spec in bench.rig.effects if spec.name not in replaced)
    effects = [*activated(listed, library), *effects]
    rig, chain_seed = with_offsets(bench.rig, offsets), int(rng.integers(2**31))
    rows = []
    for run in bench.runs:
        at = (run.condition.interference, run.condition.support_stiffness)
        signals = run_signals(
            rig, run.condition, effects, paths.of(run), run.seconds, rng, chain_seed=chain_seed,
            transfer_functions=paths.transfer_functions.at(*at),
        )  # fmt: skip
        made = record(
            signals, run.rate, run.condition, rng, Scatter(),
            decimation=LEARNING.decimation(run.rate), sensors=bench.rig.sensors,
        )  # fmt: skip
        made = _with_kinds(made, run.kinds)
        rows.append(summary(made, bench.rig, paths.transfer_functions.whole(made)))
    return _against(bench.table, rows)


def _effects(
    bench: Bench,
    hypothesis: frozenset[str],
    library: Mapping[str, Effect],
    rng: np.random.Generator,
) -> list[ActiveEffect]:
    if hypothesis == {"parameters"}:
        return []
    if hypothesis == {"unknown"}:
        name = str(rng.choice(list(UNKNOWN_EFFECTS)))
        run = bench.runs[len(bench.runs) // 2]
        fit = bench.rig.fit(run.condition.interference)
        return [unknown_effect(name, log_uniform(rng, WEAKEST, 1.0), fit, rng)]
    return [
        active_effect(name, log_uniform(rng, WEAKEST, 1.0), rng)
        if EFFECTS.get(name) is library.get(name)
        else _own_effect(library[name], rng)
        for name in sorted(hypothesis)
    ]


def _own_effect(effect: Effect, rng: np.random.Generator) -> ActiveEffect:
    """Draw a user's own effect: any form, strengths over a decade, the rest about the defaults."""
    values: dict[str, float | str] = {"form": str(rng.choice(effect.forms))}
    for name, declared in effect.parameters.items():
        size = declared.default
        if name == effect.strength:
            size = (abs(size) or 1.0) * log_uniform(rng, *_OWN_STRENGTHS)
            size *= float(rng.choice([-1.0, 1.0])) if declared.low < 0.0 else 1.0
        else:
            size *= math.exp(_OWN_SPREAD * rng.standard_normal())
        values[name] = min(max(size, declared.low), declared.high)
    return effect.active(values)


def _against(table: CaseTable, rows: Sequence[Mapping[str, float]]) -> CaseTable:
    """Put other numbers of the same runs into a table, the nominal ones being what they were."""
    names = tuple(sorted({*table.names, *(name for row in rows for name in row)}))
    place = {name: i for i, name in enumerate(table.names)}
    columns = [place.get(name, len(place)) for name in names]

    def widened(known: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.column_stack([known, np.full(len(known), np.nan)])[:, columns]

    measured = np.array([[row.get(name, math.nan) for name in names] for row in rows])
    return replace(
        table, names=names, measured=measured, nominal=widened(table.nominal),
        scatter=widened(table.scatter),
    )  # fmt: skip


def _cut(recording: Recording) -> Recording:
    n = round(LONGEST * recording.rate)
    if recording.samples.shape[1] <= n:
        return recording
    return replace(recording, samples=recording.samples[:, -n:])


def _with_kinds(recording: Recording, kinds: Sequence[str]) -> Recording:
    rows = [i for i, channel in enumerate(recording.channels) if channel.kind in kinds]
    return replace(
        recording,
        samples=recording.samples[rows],
        channels=tuple(recording.channels[i] for i in rows),
    )


def _rounded(rig: Rig) -> Rig:
    """Return a rig whose sensors' noise is one of a few values."""
    step = math.log(_NOISE_STEP)
    sensors = {
        kind: replace(sensor, noise=math.exp(step * round(math.log(sensor.noise) / step)))
        if sensor.noise
        else sensor
        for kind, sensor in rig.sensors.by_kind.items()
    }
    return replace(rig, sensors=replace(rig.sensors, by_kind=sensors))
