"""Identification of a rig: single recordings, then all of them together with the law of friction.

It determines bushing and contact. Clamp, beams and plate stay those of the known rig, by default of
the shipped bench; `noise.diagnose` shows how far off they are.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from models.bushing import TemperatureDependence
from models.condition import FIXED
from models.errors import ParameterError
from models.rig import Rig
from models.rig_file import rig_text
from models.schema import remarks
from noise.base import SURE_90
from noise.diagnosis.bench.check import unit_findings
from noise.identification.bushing_fit import fit_bushing, torque_levels
from noise.identification.law_fit import MARGIN, LawFit, choose_law
from noise.identification.law_model import CANDIDATES, LOCAL, Candidate, subjects_of
from noise.identification.measured import (
    Beforehand,
    Measured,
    known_beforehand,
    read_measurements,
)
from noise.identification.outcome import (
    UNITS,
    Forecast,
    Identification,
    LawScore,
    Number,
    RecordingFit,
)
from sim.effects import EFFECTS
from sim.friction import friction_law


class NothingSlipsError(ParameterError):
    """Error of recordings that are valid but have too few slips."""


def identify_rig(
    measured: Sequence[Measured],
    refused: Sequence[tuple[str, str]],
    beforehand: Beforehand,
    *,
    progress: Callable[[str], None] | None = None,
) -> Identification:
    """Identify a rig from measurements.

    Parameters
    ----------
    measured : sequence of Measured
    refused : sequence of (str, str)
        Name and reason of each recording that is left out.
    beforehand : Beforehand
        Prior knowledge of the rig.
    progress : callable, optional
        Called with each step and the first numbers.

    Returns
    -------
    Identification

    Raises
    ------
    ParameterError
        No recording can be used, or nothing slips in any of them.
    """
    started = time.perf_counter()
    if not measured:
        reasons = "; ".join(f"{name}: {reason}" for name, reason in refused)
        raise ParameterError(f"no recording that a rig can be identified from: {reasons}")
    if units := unit_findings([one.recording for one in measured], beforehand.rig):
        raise ParameterError(f"{'; '.join(units)}; put units right in the sidecars")
    tell = progress or (lambda _text: None)
    recordings = []
    for one in measured:
        alone = fit_bushing(one, beforehand.known)
        recordings.append(RecordingFit(one, alone, torque_levels(alone)))
        levels = recordings[-1].levels
        tell(
            f"{one.name}: damping {alone.damping:.3g} Nm s/rad, breaks at {levels.critical:.3g} "
            f"and slides at {levels.kinetic:.3g} Nm, {levels.slips} slips"
        )
    if not any(one.levels.slips for one in recordings):
        raise NothingSlipsError(
            "no recording shows stick and slip, so that neither stiffness nor torques can be told; "
            "record slower rotation, or a larger interference"
        )
    subjects = subjects_of(recordings, beforehand.known)
    if not subjects:
        raise NothingSlipsError(
            "no recording shows enough slips one like the other to tell a law; record longer, at "
            "one steady speed"
        )
    fit, scores, held_out = choose_law(beforehand.known, subjects, tell)
    model = fit.model
    recordings = read_again(recordings, fit)
    stated = {one.measured.condition.material for one in recordings} - {None}
    material = str(stated.pop() if len(stated) == 1 else beforehand.rig.material)
    rig = replace(
        model.rig(fit.vector, beforehand.rig, material),
        fastest_fitted=max(one.measured.written_speed for one in recordings),
        temperature=dependence_of(beforehand.rig, recordings, material),
    )
    assumed, undetermined = _assumed(beforehand, recordings)
    return Identification(
        rig_toml=rig_text(rig, (_HEAD, f"{_structure(beforehand)}."), beforehand.structure),
        numbers=(*bushing_numbers(recordings, fit), *law_numbers(fit, rig)),
        laws=scores,
        law=model.candidate.name,
        recordings=tuple(recordings),
        assumed=assumed,
        not_found=undetermined,
        notes=(
            *remarks(rig),
            *_notes(model.candidate, scores, held_out),
        ),
        refused=tuple(refused),
        held_out=held_out,
        margin=MARGIN,
        seconds=time.perf_counter() - started,
    )


def identify(
    data: str | Path | Sequence[str | Path], rig: str | Path | None = None
) -> Identification:
    """Identify a rig from recordings.

    Parameters
    ----------
    data : path or sequence of paths
        Recordings of torque and angle, or folders with such recordings.
    rig : path, optional
        Rig file with known numbers, above all the two inertias.

    Returns
    -------
    Identification

    Raises
    ------
    ParameterError
        Rig file or recordings cannot be used.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     identify(folder)
    Traceback (most recent call last):
    models.errors.ParameterError: ...
    """
    paths = [Path(data)] if isinstance(data, str | Path) else [Path(path) for path in data]
    beforehand = known_beforehand(None if rig is None else Path(rig))
    return identify_rig(*read_measurements(paths), beforehand)


def result_lines(result: Identification) -> list[str]:
    """Return the law and the numbers of a rig file with their 90 % intervals, by interference.

    Parameters
    ----------
    result : Identification

    Examples
    --------
    >>> numbers = (
    ...     Number("elastomer_stiffness", "Nm/rad", 764.9, 747.1, 783.1, 6, 0.279e-3),
    ...     Number("critical_torque", "Nm", 11.73, 11.58, 11.89, 6, 0.279e-3),
    ...     Number("law_critical_torque", "Nm", 11.77, 11.56, 11.99, 6, 0.279e-3),
    ... )
    >>> result_lines(Identification("", numbers, (), "constant", ()))
    ['law = "coulomb"; at 0.279 mm: stiffness 764.9 (747.1 to 783.1) Nm/rad, critical torque 11.77
      (11.56 to 11.99) Nm; 90 % intervals']
    """
    law = next(one.in_rig_file for one in CANDIDATES if one.name == result.law)
    parts: dict[float, list[str]] = {}
    for name, words in _SUMMARY.items():
        for one in (one for one in result.numbers if one.name == name):
            where = ""
            if one.support_stiffness is not None:
                where = f" at a support of {one.support_stiffness:g} Nm/rad"
                where = " with the clamp fixed" if one.support_stiffness == FIXED else where
            interval = f"{one.value:.4g} ({one.low:.4g} to {one.high:.4g})"
            here = parts.setdefault(one.interference or 0.0, [])
            here.append(f"{words}{where} {interval} {one.unit}")
    return [
        f"{law}; at {1e3 * place:g} mm: {', '.join(parts[place])}; 90 % intervals"
        for place in sorted(parts)
    ]


_SUMMARY = {
    "elastomer_stiffness": "stiffness",
    "damping": "damping",
    "law_critical_torque": "critical torque",
    "law_kinetic_torque": "kinetic torque",
}
"""Numbers of the summary, in words."""


def _notes(
    candidate: Candidate, scores: Sequence[LawScore], held_out: Sequence[str]
) -> tuple[str, ...]:
    notes = []
    if not held_out:
        notes.append(
            "too few conditions to hold one out: the laws are judged by the recordings they were "
            "fitted to; record more speeds"
        )
    best = scores[0]
    chosen = next(s for s in scores if s.law == candidate.name)
    if not candidate.sticks:
        notes.append(
            "this law's contact creeps while it sticks, which looks like damping. On rigs of a "
            "second simulator the damping came out up to a quarter too large, and up to two fifths "
            "with the clamp bolted down"
        )
    rivals = [s.law for s in scores if s.missed <= _RIVALS * best.missed and s != chosen]
    if rivals:
        notes.append(f"these recordings hardly tell {' and '.join([chosen.law, *rivals])} apart")
    if max(chosen.missed, chosen.held_out) > _MISSED:
        notes.append(
            f"no law describes these recordings, so do not trust the numbers. The best law leaves "
            f"{100.0 * chosen.held_out:.0f} % of the oscillation within a cycle unexplained. "
            "diagnose finds which effect is missing"
        )
    return tuple(notes)


_RIVALS = 1.2
"""Ratio to the smallest misfit up to which a law is named beside the chosen one; assumed."""

_MISSED = 0.2
"""Share of the oscillation missed above which no law describes the recordings; assumed."""

_HEAD = "Identified from recordings; intervals and what is assumed are in identification.json."


def dependence_of(
    rig: Rig, recordings: Sequence[RecordingFit], material: str
) -> TemperatureDependence | None:
    """Return the known rig's dependence on temperature, relative to that of the recordings.

    Parameters
    ----------
    rig : Rig
        Known rig.
    recordings : sequence of RecordingFit
    material : str
        Of the recordings; another than the rig's depends in an unknown way.
    """
    stated = [one.measured.condition.temperature for one in recordings]
    known = [value for value in stated if value is not None]
    if rig.temperature is None or rig.material != material:
        return None
    return rig.temperature.at_reference(sum(known) / len(known)) if known else rig.temperature


def _structure(beforehand: Beforehand) -> str:
    whose = beforehand.structure or "the shipped bench"
    return f"structure, plate and microphone are those of {whose}"


def _assumed(
    beforehand: Beforehand, recordings: Sequence[RecordingFit]
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    assumed, undetermined = [_structure(beforehand)], []
    flexible = any(not one.fit.bushing.clamp_is_fixed for one in recordings)
    if "elastomer_damping_share" not in beforehand.stated and not flexible:
        assumed.append(
            "damping is split evenly between elastomer and beams, as the thesis does: with the "
            "clamp bolted down only the elastomer's can be told"
        )
    if not beforehand.inertias_stated:
        assumed.append(
            "no inertia is stated: a contact that gives way elastically counts as elastomer; state "
            "elastomer_inertia_kgm2 and clamp_inertia_kgm2 in --rig"
        )
    if not flexible:
        undetermined.append("clamp inertia: all recordings were made with the clamp fixed")
    recorded, slipping = (
        {one.measured.condition.interference for one in some}
        for some in (recordings, [one for one in recordings if one.levels.slips])
    )
    undetermined += [
        f"anything at {1e3 * interference:g} mm: nothing slips there; record slower rotation"
        for interference in sorted(recorded - slipping)
    ]
    return tuple(assumed), tuple(undetermined)


# --- numbers with 90 % intervals -----------------------------------------------------------------

_OF_THE_LAW = {
    "elastomer_stiffness": (0.015, 0.01),
    "damping": (0.13, 0.055),
    "elastomer_inertia": (0.03, 0.02),
    "clamp_inertia": (0.02, 0.01),
    "elastomer_damping_share": (0.2, 0.1),
}
"""Relative systematic error, because no law is exact, of a law whose contact creeps and of one that
truly sticks [-]; from 26 development rigs of `tests.blind.identify`, seed 1."""

_TORQUE_SCATTER, _TORQUE_SHARED = 0.018, 0.003
"""Relative scatter of a level between recordings at one speed, and its systematic error by the
low-pass filter [-]; from the same 26 rigs."""


def read_again(recordings: Sequence[RecordingFit], fit: LawFit) -> list[RecordingFit]:
    """Return the recordings with the bushings that the fit of the law gave them.

    Parameters
    ----------
    recordings : sequence of RecordingFit
    fit : LawFit

    Returns
    -------
    list of RecordingFit
        Recordings that the law was not fitted to are unchanged.
    """
    model, own = fit.model, {}
    for subject, numbers, torque in zip(
        model.subjects, np.exp(model.local(fit.vector)).tolist(), model.predicted(fit.vector),
        strict=True,
    ):  # fmt: skip
        e = subject.excerpts
        middle = e.starts.size // 2
        forecast = None if torque is None else Forecast(e.rate, e.torque[middle], torque[middle])
        own[id(subject.measured)] = model.bushing(numbers, subject), forecast
    again = []
    for one in recordings:
        if id(one.measured) in own:
            bushing, forecast = own[id(one.measured)]
            refitted = replace(one.fit, bushing=bushing)
            one = RecordingFit(one.measured, refitted, torque_levels(refitted), forecast)
        again.append(one)
    return again


def bushing_numbers(recordings: Sequence[RecordingFit], fit: LawFit) -> list[Number]:
    """Return the rig's numbers.

    Parameters
    ----------
    recordings : sequence of RecordingFit
        As of `read_again`.
    fit : LawFit
        To all recordings that slip.

    Returns
    -------
    list of Number
        Stiffness and torques by interference, damping by interference and support, inertias.
    """
    stiffness, *others = (_of_fit(fit, name) for name in _OF_THE_LAW)
    return [*stiffness, *_levels(recordings), *itertools.chain(*others)]


def _of_fit(fit: LawFit, name: str) -> list[Number]:
    model, place = fit.model, LOCAL.index(name)
    means, spread = model.means(fit.vector), np.sqrt(np.diag(fit.covariance))
    shared = _OF_THE_LAW[name][model.candidate.sticks]
    numbers = []
    for g, (i, key) in enumerate(model.groups):
        if i == place:
            at = key if isinstance(key, tuple) else (key, None)
            error = math.hypot(float(spread[model.n_local + g]), shared)
            n = int(np.sum(model.group_of[:, i] == g))
            numbers.append(_number(name, UNITS[name], math.exp(means[g]), error, n, *at))
    return sorted(numbers, key=lambda n: (n.interference or 0.0, n.support_stiffness or 0.0))


def _number(name: str, unit: str, value: float, error: float, n: int, *at: float | None) -> Number:
    """Return a number with the 90 % interval of its relative standard error."""
    away = math.exp(SURE_90 * error)
    return Number(name, unit, value, value / away, value * away, n, *at)


def _levels(recordings: Sequence[RecordingFit]) -> list[Number]:
    """Return the mean torque levels of the recordings by interference."""
    slipping = [one for one in recordings if one.levels.slips]
    places = sorted({one.measured.condition.interference for one in slipping})
    numbers = []
    for name, at in itertools.product(("critical_torque", "kinetic_torque"), places):
        values = [
            getattr(one.levels, name.removesuffix("_torque"))
            for one in slipping
            if one.measured.condition.interference == at
        ]
        # levels that change with speed make their mean no less certain
        value, n = float(np.exp(np.mean(np.log(values)))), len(values)
        error = math.hypot(_TORQUE_SCATTER / math.sqrt(n), _TORQUE_SHARED)
        numbers.append(_number(name, UNITS[name], value, error, n, at))
    return numbers


def law_numbers(fit: LawFit, rig: Rig) -> list[Number]:
    """Return the torques and parameters of the friction law.

    Parameters
    ----------
    fit : LawFit
        To all recordings.
    rig : Rig
        Rig identified by the fit.
    """
    model, spread = fit.model, np.sqrt(np.diag(fit.covariance))
    error = {group: float(spread[model.n_local + g]) for g, group in enumerate(model.groups)}
    numbers = []
    kinetic_torque = LOCAL.index("kinetic_torque")
    for one in rig.fits:
        g = model.groups.index((kinetic_torque, one.interference))
        n = int(np.sum(model.group_of[:, kinetic_torque] == g))
        kinetic = error[kinetic_torque, one.interference]
        drop = error[LOCAL.index("drop"), one.interference]
        critical = math.hypot(kinetic, (1.0 - one.kinetic_torque / one.critical_torque) * drop)
        for name, value, of in (
            ("law_kinetic_torque", one.kinetic_torque, kinetic),
            ("law_critical_torque", one.critical_torque, critical),
        ):
            numbers.append(_number(name, "Nm", value, min(of, _UNKNOWN), n, one.interference))
    candidate = model.candidate
    own = EFFECTS[candidate.effect].parameters if candidate.effect else None
    units = own or friction_law(candidate.law).parameters
    for i, name in enumerate(candidate.free, start=model.n_common):
        unit, error_of = units[name].unit, min(float(spread[i]), _UNKNOWN)
        value, n = math.exp(fit.vector[i]), len(model.subjects)
        numbers.append(_number(f"friction.{name}", unit, value, error_of, n))
    return numbers


_UNKNOWN = 2.0
"""Largest relative standard error that is stated for a number of the law [-]."""
