"""Diagnosis of a case: verdict, probabilities, fits and notes from recordings and a rig file.

In order: does the rig file describe the recordings to within what repeats differ by; where not;
which causes are how probable together; how far parameters alone, and the likeliest of these with
them, close the gap on recordings that the fit did not use, and how probable that leaves them.

Which bushing is compared with where the rig file states none: that shipped for its material.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from models.condition import known_condition
from models.rig import Rig
from models.rig_file import load_material_rig, load_rig, material_names
from noise.base.remarks import effect_remarks, temperature_remark, use_remarks
from noise.base.user_effects import effect_library
from noise.diagnosis.bench.check import bench_findings
from noise.diagnosis.case import Case, read_case
from noise.diagnosis.causes.advice import channel_costs, equivalent_pairs, next_measurement
from noise.diagnosis.causes.location import (
    StageNulls,
    differences,
    load_stage_nulls,
    locate,
    stage_findings,
)
from noise.diagnosis.causes.posterior import load_posterior
from noise.diagnosis.causes.verdict import UNUSUAL
from noise.diagnosis.first_answer import FirstAnswer, first_answer
from noise.diagnosis.outcome import Agreement, Diagnosis, EffectFinding, StageFinding
from noise.diagnosis.sentences import AGREES
from noise.diagnosis.signature import KINDS
from sim.effects import EFFECTS
from sim.effects.effect import Effect, Stage

if TYPE_CHECKING:
    from noise.diagnosis.fit.decide import Judged

_SHOWN = 5
"""Effects that are listed at least; assumed."""

_AS_REPEATS = 0.5
"""p-value from which on a stage differs as repeats do [-]; assumed."""


_ROOM, _NEAR_ROOM = 23.0, 5.0
"""At which the shipped bushings are given, and about which they are as they are
[degree Celsius]; assumed."""


def diagnose(
    data: str | Path | Sequence[str | Path],
    rig: Rig | str | Path,
    *,
    quick: bool = False,
    effects: str | Path | Sequence[str | Path] = (),
    seed: int = 0,
) -> Diagnosis:
    """Compare recordings with the simulator and name the missing effects.

    Parameters
    ----------
    data : path or sequence of paths
        Recordings, or folders of them.
    rig : Rig or path
        Rig, or its file.
    quick : bool
        Whether to return the first answer, without fits.
    effects : path or sequence of paths
        Python files that define further effects. They are executed.
    seed : int
        Of simulated repeats and bootstraps.

    Returns
    -------
    Diagnosis
        Its ``improved`` is the improved rig, None if nothing closes the gap.

    Raises
    ------
    ParameterError
        Rig file, recordings or effects cannot be used.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     rig = Path(folder) / "rig.toml"
    ...     size = rig.write_text('name = "bench"', encoding="utf-8")
    ...     diagnose(folder, rig)
    Traceback (most recent call last):
    models.errors.ParameterError: ...
    """
    paths, own = (
        [Path(given)] if isinstance(given, str | Path) else [Path(path) for path in given]
        for given in (data, effects)
    )
    library = effect_library(own)
    case = read_case(paths, rig if isinstance(rig, Rig) else load_rig(rig))
    return diagnose_case(case, quick=quick, library=library, seed=seed)


def diagnose_case(
    case: Case,
    *,
    quick: bool = False,
    library: Mapping[str, Effect] | None = None,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
) -> Diagnosis:
    """Diagnose a case.

    Parameters
    ----------
    case : Case
    quick : bool
        Whether to give the first answer alone, without fits.
    library : mapping of str to Effect, optional
        Effects that may be missing, the user's own among them.
    seed : int
        Of simulations and bootstraps.
    progress : callable, optional
        Told what is being done.

    Returns
    -------
    Diagnosis
    """
    started = time.perf_counter()
    tell = progress or (lambda _text: None)
    library = library or EFFECTS
    tell("checking that it is this rig")
    if findings := bench_findings(case, library):
        answer = _another_bench(case, findings, library)
        return replace(answer, seconds=time.perf_counter() - started)
    posterior, nulls = load_posterior(), load_stage_nulls()
    first = first_answer(case, library, posterior, seed, tell)
    if quick:
        answer = _stated(case, first, first, nulls, library)
    else:
        from noise.diagnosis.fit.decide import fit_notes, judge  # no part of a quick answer, and
        from noise.diagnosis.fit.fits import add_fits  # loads the classifier

        judged = judge(case, first, library, posterior, seed, tell)
        answer = _stated(case, first, judged, nulls, library)
        answer = add_fits(case, answer, judged, posterior, seed, tell)
        answer = replace(answer, notes=(*answer.notes, *fit_notes(judged)))
    return replace(answer, seconds=time.perf_counter() - started)


def _stated(
    case: Case,
    first: FirstAnswer,
    judged: FirstAnswer | Judged,
    nulls: StageNulls,
    library: Mapping[str, Effect],
) -> Diagnosis:
    """Return a diagnosis with location, alternatives and next measurement."""
    verdict, probabilities, table = judged.verdict, judged.probabilities, first.comparison.table
    findings = stage_findings(table, nulls)
    ranked = sorted(probabilities, key=lambda name: -probabilities[name])
    ranked = [name for name in ranked if name in library]
    stage = library[verdict[0]].stage.value if verdict and verdict[0] in library else None
    if stage is not None and findings[stage].p_value >= _AS_REPEATS:
        stage = None  # it shows elsewhere
    place = locate(table, nulls, stage)
    agreement = []
    for name, recording, gap, each in zip(
        case.names, case.recordings, first.gap.of_recordings, first.gap.of_channels, strict=True
    ):
        at = known_condition(recording.condition)
        channels = {k: float(d) for k, d in zip(KINDS, each, strict=True) if math.isfinite(d)}
        agreement.append(Agreement(name, at.speed, at.interference, float(gap), channels))
    farthest = max(agreement, key=lambda one: one.gap)
    suspected = (
        f"what is left looks like {name}, which the rig file lists already: its form or numbers "
        "are off"
        for name in first.suspected
    )
    return Diagnosis(
        verdict=verdict,
        equivalent=equivalent_pairs(ranked, probabilities, case.kinds),
        location=place if verdict else None,
        stages=findings,
        effects=tuple(
            EffectFinding(name, library[name].stage.value, probabilities[name])
            for name in ranked[:_SHOWN]
        ),
        probabilities=probabilities,
        next_measurement=next_measurement(
            verdict,
            probabilities,
            case.kinds,
            place.stage,
            differs=first.gap.p_value <= UNUSUAL,
            farthest=farthest.recording if farthest.gap > AGREES else "",
            own_fit=not assumed_fit(case.rig),
        ),
        gap=first.gap.distance,
        p_value=first.gap.p_value,
        notes=(
            *case.faults,
            *suspected,
            *_notes(case),
            *first.unlearned,
            *case_remarks(case, library),
        ),
        differences=differences(table, nulls),
        agreement=tuple(agreement),
        faults=case.faults,
    )


def _another_bench(
    case: Case, reasons: tuple[str, ...], library: Mapping[str, Effect]
) -> Diagnosis:
    """Return a diagnosis without a cause, of recordings that cannot be of their rig."""
    nothing = StageFinding(math.nan, math.nan, math.nan)
    return Diagnosis(
        verdict=("unknown",),
        stages={stage.value: nothing for stage in Stage},
        probabilities=dict.fromkeys(("none", "parameters", *EFFECTS), 0.0) | {"unknown": 1.0},
        next_measurement="put the recordings or their sidecars right, and diagnose them again",
        notes=(*reasons, *case.faults, *_notes(case), *case_remarks(case, library)),
        bench=reasons,
        faults=case.faults,
    )


def assumed_fit(rig: Rig) -> str:
    """Return a note on the shipped bushing of a rig that was given none of its own, or nothing.

    Examples
    --------
    >>> assumed_fit(load_material_rig("fluorocarbon-thesis"))
    'no [[fit]] of its own in the rig file: the bushing is that shipped for fluorocarbon-thesis;
      identify makes a rig file of recordings'
    """
    shipped = [name for name in material_names() if load_material_rig(name).fits == rig.fits]
    if not shipped:
        return ""
    return (
        "no [[fit]] of its own in the rig file: the bushing is that shipped for "
        f"{rig.material if rig.material in shipped else shipped[0]}; identify makes a rig file of "
        "recordings"
    )


def case_remarks(case: Case, library: Mapping[str, Effect]) -> list[str]:
    """Return remarks on a rig and the conditions of its recordings.

    Parameters
    ----------
    case : Case
    library : mapping of str to Effect
        Effects that the rig's can be found among.

    Returns
    -------
    list of str
        One line each, each once.
    """
    at = [known_condition(recording.condition) for recording in case.recordings]
    heat = sorted({c.temperature for c in at if c.temperature is not None})
    shipped = assumed_fit(case.rig)
    elsewhere = shipped and any(abs(t - _ROOM) > _NEAR_ROOM for t in heat)
    remarks = [
        shipped,
        *use_remarks(
            case.rig,
            speed=[c.speed for c in at],
            interference=[c.interference for c in at],
            support_stiffness=[c.support_stiffness for c in at],
            temperature=heat,
        ),
        *effect_remarks(case.rig, library),
        temperature_remark(case.rig, *heat)
        if case.rig.temperature or len(heat) > 1 or elsewhere
        else "",
    ]
    return [text for text in dict.fromkeys(remarks) if text]


def _notes(case: Case) -> list[str]:
    notes = channel_costs(case.kinds)
    different = {recording.condition for recording in case.recordings}
    if len(case.recordings) == 1:
        notes.append(
            "one recording: what it was fitted to is what it is judged by; record more conditions"
        )
    elif len(different) == len(case.recordings):
        notes.append("no condition was recorded twice: how much repeats differ is assumed (2 %)")
    notes += case.notes
    notes += [f"{r.name}: {text}" for r in case.recordings for text in r.notes]
    return [*notes, *(f"{name} was left out: {reason}" for name, reason in case.refused)]
