"""Location of a gap: stage by stage, each fed with what was measured before it.

The contact is rebuilt from the measured torque, the structure is driven by it, the sound is
predicted from it, the shaft's motion is read off its angle. So an error of one stage does not show
in the next ones, but for the loop through which drive and contact hang together. Each number of a
recording belongs to a stage, a channel, a band or a phase of the cycle; how unlikely its difference
is follows from the largest one that cases without a cause have in that stage, which corrects for
the number of looks.
"""

from __future__ import annotations

import warnings
from collections.abc import Collection
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from noise.diagnosis.causes.stage_nulls import STAGES, StageNulls, largest_of, stage_of
from noise.diagnosis.evidence.bands import BAND_EDGES
from noise.diagnosis.evidence.evidence import deviations
from noise.diagnosis.findings import LARGEST_GAP, SURE, Location, StageFinding

if TYPE_CHECKING:
    from noise.diagnosis.evidence.summary import CaseTable


_FLAT = len(STAGES) / 140.0
"""p-value of the measurement where a channel's peaks are flat [-]: none of 139 development cases
without clipping had such (`noise.diagnosis.first_answer`), and there are five stages."""

_WHOLE_BAND = (0.0, 1800.0)
"""Of a difference that is in no band: where the contact's cycle lives [Hz]; assumed."""

_STICK = ("creep", "stick", "stiffness", "calm", "after", "before", "ring", "slow_")

_PHASES = {
    "stick": (*_STICK, "time_stuck"),
    "slip": ("law", "fastest", "duration", "kinetic", "trough", "slip"),
    "cycle": ("peak", "interval", "spread", "skewness", "highest", "lowest", "friction"),
}


def stage_findings(
    table: CaseTable, nulls: StageNulls, flat: Collection[str] = ()
) -> dict[str, StageFinding]:
    """How each stage differs.

    The gap is that of the number that differs most, over what is usual without a cause; the
    p-value is that of the most surprising one, corrected for the looks within and between stages.

    Parameters
    ----------
    table : CaseTable
    nulls : StageNulls
    flat : collection of str
        Kinds of channel that are overloaded: whatever differs in them is the sensor's.
    """
    size, surprise = nulls.sizes(table), nulls.surprises(table)
    stages = np.array([_stage(name, flat) for name in nulls.names])
    found = {}
    for i, stage in enumerate(STAGES):
        inside = stages == stage
        gap = min(largest_of(size[inside]) / float(nulls.typical[i]), LARGEST_GAP)
        found[stage] = (gap, _p_value(largest_of(surprise[inside]), nulls.largest[:, i]))
    if flat:
        gap, p_value = found["measurement"]
        found["measurement"] = (gap, min(p_value, _FLAT))
    excess = {stage: max(gap - 1.0, 0.0) ** 2 for stage, (gap, _) in found.items()}
    whole = sum(excess.values())
    return {
        stage: StageFinding(gap, excess[stage] / whole if whole > 0.0 else 0.0, p_value)
        for stage, (gap, p_value) in found.items()
    }


def locate(
    table: CaseTable, nulls: StageNulls, stage: str | None = None, flat: Collection[str] = ()
) -> Location:
    """Say where the difference is most certain.

    Parameters
    ----------
    table : CaseTable
    nulls : StageNulls
    stage : str, optional
        Where to look; by default the stage that differs most surely.
    flat : collection of str
        As of `stage_findings`.
    """
    findings = stage_findings(table, nulls, flat)
    if stage is None:
        stage = min(findings, key=lambda name: (findings[name].p_value, -findings[name].gap))
    names = nulls.names
    inside = np.array([_stage(name, flat) == stage for name in names])
    if not inside.any():
        inside[:] = True
    sizes = np.nan_to_num(nulls.surprises(table))
    size = np.where(inside, sizes, -1.0)
    strongest = np.argsort(size)[::-1][:12]
    strongest = strongest[size[strongest] >= 0.5 * size[strongest[0]]]
    top = names[int(strongest[0])]
    channels = {_channel(names[int(i)]) for i in strongest}
    bands = [band for i in strongest if (band := _band(names[int(i)])) is not None]
    low, high = (min(b[0] for b in bands), max(b[1] for b in bands)) if bands else _WHOLE_BAND
    return Location(
        stage=stage,
        channels=tuple(c for c in ("torque", "acceleration", "pressure", "angle") if c in channels),
        band=(low, high),
        phase=_phase(top),
        conditions=_conditions(table, nulls, strongest),
        p_value=findings[stage].p_value,
    )


def differences(
    table: CaseTable, nulls: StageNulls, flat: Collection[str] = ()
) -> tuple[Location, ...]:
    """Look at every stage, channel, band and phase of the cycle.

    Parameters
    ----------
    table : CaseTable
    nulls : StageNulls
    flat : collection of str
        As of `stage_findings`.

    Returns
    -------
    tuple of Location
        Those that differ, the surest first; empty where none does. A p-value is that of the place's
        largest surprise among the largest ones that whole stages have without a cause, so it is
        corrected for all looks.
    """
    names = nulls.names
    size = nulls.surprises(table)
    places: dict[tuple[str, str, tuple[float, float] | None, str], list[int]] = {}
    for i, name in enumerate(names):
        if np.isfinite(size[i]):
            key = (_stage(name, flat), _channel(name), _band(name), _phase(name))
            places.setdefault(key, []).append(i)
    found = []
    for (stage, channel, band, phase), numbers in places.items():
        largest = np.array(numbers)[np.argsort(-size[numbers])][:3]
        most = float(size[largest[0]])
        null = nulls.largest[:, STAGES.index(stage)]
        place = Location(
            stage, (channel,), band or _WHOLE_BAND, phase, _conditions(table, nulls, largest),
            _p_value(most, null),
        )  # fmt: skip
        if place.p_value <= SURE:
            found.append((place.p_value, -most, place))
    return tuple(place for _, _, place in sorted(found, key=lambda entry: entry[:2]))


def _stage(name: str, flat: Collection[str]) -> str:
    return "measurement" if _channel(name) in flat else stage_of(name)


def _p_value(size: float, null: NDArray[np.float64]) -> float:
    """Probability of so large a difference without a cause, corrected for all stages [-]."""
    beyond = int(np.count_nonzero(null >= size))
    return min(1.0, len(STAGES) * (1.0 + beyond) / (len(null) + 1.0))


def _channel(name: str) -> str:
    kind = name.partition("_")[0]
    return {"contact": "torque", "common": "acceleration"}.get(kind, kind)


def _band(name: str) -> tuple[float, float] | None:
    head, _, number = name.rpartition("_")
    if not number.isdigit() or "_" not in head:
        return None
    what = head.partition("_")[2]
    if what not in ("gain", "incoherent", "transfer", "left", "excess", "level", "band"):
        return None
    i = int(number)
    return float(BAND_EDGES[i - 1]), float(BAND_EDGES[i])


def _phase(name: str) -> str:
    kind, _, what = name.partition("_")
    if kind != "contact":
        return "all"
    return next((phase for phase, heads in _PHASES.items() if what.startswith(heads)), "cycle")


def _conditions(table: CaseTable, nulls: StageNulls, strongest: NDArray[np.int64]) -> str:
    """In which conditions it shows, if only fast or only slow ones."""
    turned = np.array([c.speed for c in table.conditions], dtype=np.float64)
    speed = np.abs(turned)
    if np.unique(speed).size < 3:
        return "all"
    z = np.abs(deviations(table, nulls.names, nulls.scale)[:, strongest])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        size = np.nanmean(z, axis=1)
    middle = float(np.median(speed))
    fast, slow = size[speed >= middle].mean(), size[speed < middle]
    if not slow.size or not np.isfinite(fast):
        return "all"
    ways = ((">=", "<"), ("<=", ">"))[int(np.all(turned <= 0.0))]
    limit = -middle if np.all(turned <= 0.0) else middle
    if fast > 2.0 * slow.mean():
        return f"speed_rad_s {ways[0]} {limit:g}"
    if slow.mean() > 2.0 * fast:
        return f"speed_rad_s {ways[1]} {limit:g}"
    return "all"
