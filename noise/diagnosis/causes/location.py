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
from typing import TYPE_CHECKING

import numpy as np

from noise.diagnosis.evidence.channel_summary import BAND_EDGES
from noise.diagnosis.evidence.evidence import deviations, standard_errors
from noise.diagnosis.findings import LARGEST_GAP, Location, StageFinding
from sim.effects.effect import Stage

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from noise.diagnosis.causes.posterior import Posterior
    from noise.diagnosis.evidence.summary import CaseTable

__all__ = ["STAGES", "differences", "locate", "null_maxima", "stage_findings", "stage_of"]

STAGES = tuple(stage.value for stage in Stage)
"""In the order of the chain."""

_HEALTH = (
    "top", "bottom", "crest", "asymmetry", "flat", "dwell", "offset", "floor", "hum", "low_floor",
    "high_floor", "delay", "phase_match", "raw",
)  # fmt: skip
"""Numbers that tell a sensor's fault rather than the rig's."""

_OVERALL = ("band", "level", "raw", "skewness")
"""Numbers that a channel has of all that comes before it: with a torque to compare with, they tell
nothing of the channel's own stage."""

_WHOLE_BAND = (0.0, 1800.0)
"""Of a difference that is in no band: where the contact's cycle lives [Hz]."""

_STICK = ("creep", "stick", "stiffness", "calm", "after", "before", "ring", "slow_")

_PHASES = {
    "stick": (*_STICK, "time_stuck"),
    "slip": ("law", "fastest", "duration", "kinetic", "trough", "slip"),
    "cycle": ("peak", "interval", "spread", "skewness", "highest", "lowest", "friction"),
}


def stage_of(name: str) -> str:
    """Stage that a number tells of.

    Examples
    --------
    >>> stage_of("contact_peak"), stage_of("pressure_gain_4"), stage_of("pressure_hum_50")
    ('friction', 'radiation', 'measurement')
    """
    kind, _, what = name.partition("_")
    if kind == "angle":
        return "drive"
    if what.startswith(_HEALTH):
        return "measurement"
    return {"acceleration": "structure", "pressure": "radiation", "common": "structure"}.get(
        kind, "friction"
    )


def null_maxima(
    tables: Sequence[CaseTable], names: Sequence[str], scale: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Largest differences of each stage in cases without a cause.

    Returns
    -------
    ndarray, shape (n_cases, n_stages)
        Each column rising, in standard errors [-].
    """
    stages = np.array([stage_of(name) for name in names])
    sizes = [np.abs(_standard_errors(table, names, scale)) for table in tables]
    return np.sort(
        np.array([[_most(size[stages == stage]) for stage in STAGES] for size in sizes]), axis=0
    )


def stage_findings(table: CaseTable, posterior: Posterior) -> dict[str, StageFinding]:
    """How each stage differs.

    The gap is that of the number that differs most, over what is usual without a cause; the
    p-values are corrected for the looks within and between stages.
    """
    size = np.abs(_standard_errors(table, posterior.names, posterior.scale))
    stages = np.array([stage_of(name) for name in posterior.names])
    found = {}
    for i, stage in enumerate(STAGES):
        most = _most(size[stages == stage])
        null = posterior.null[:, i]
        gap = most / max(float(np.median(null)), 1e-9)
        found[stage] = (min(gap, LARGEST_GAP), _p_value(most, null))
    excess = {stage: max(gap - 1.0, 0.0) ** 2 for stage, (gap, _) in found.items()}
    whole = sum(excess.values())
    return {
        stage: StageFinding(gap, excess[stage] / whole if whole > 0.0 else 0.0, p_value)
        for stage, (gap, p_value) in found.items()
    }


def locate(table: CaseTable, posterior: Posterior, stage: str | None = None) -> Location:
    """Say where the difference is most certain.

    Parameters
    ----------
    table : CaseTable
    posterior : Posterior
    stage : str, optional
        Where to look; by default the stage that differs most.
    """
    findings = stage_findings(table, posterior)
    if stage is None:
        stage = max(findings, key=lambda name: findings[name].gap)
    names = posterior.names
    inside = np.array([stage_of(name) == stage for name in names])
    if not inside.any():
        inside[:] = True
    sizes = np.nan_to_num(np.abs(_standard_errors(table, names, posterior.scale)))
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
        conditions=_conditions(table, posterior, strongest),
        p_value=findings[stage].p_value,
    )


def differences(table: CaseTable, posterior: Posterior) -> tuple[Location, ...]:
    """Look at every stage, channel, band and phase of the cycle.

    Parameters
    ----------
    table : CaseTable
    posterior : Posterior

    Returns
    -------
    tuple of Location
        The surest first. A p-value is that of the place's largest difference among the largest ones
        that whole stages have without a cause, so it is corrected for all looks.
    """
    names = posterior.names
    size = np.abs(_standard_errors(table, names, posterior.scale))
    places: dict[tuple[str, str, tuple[float, float] | None, str], list[int]] = {}
    for i, name in enumerate(names):
        if np.isfinite(size[i]):
            key = (stage_of(name), _channel(name), _band(name), _phase(name))
            places.setdefault(key, []).append(i)
    found = []
    for (stage, channel, band, phase), numbers in places.items():
        largest = np.array(numbers)[np.argsort(-size[numbers])][:3]
        most = float(size[largest[0]])
        null = posterior.null[:, STAGES.index(stage)]
        place = Location(
            stage, (channel,), band or _WHOLE_BAND, phase, _conditions(table, posterior, largest),
            _p_value(most, null),
        )  # fmt: skip
        found.append((place.p_value, -most, place))
    return tuple(place for _, _, place in sorted(found, key=lambda entry: entry[:2]))


def _standard_errors(
    table: CaseTable, names: Sequence[str], scale: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Mean difference of each number in units of its standard error; NaN where it tells nothing."""
    z = deviations(table, names, scale)
    errors = np.where(np.isfinite(z).any(axis=0), standard_errors(z), np.nan)
    if any(name.startswith("contact") for name in table.names):
        errors[[_is_overall(name) for name in names]] = np.nan
    return np.asarray(errors)


def _is_overall(name: str) -> bool:
    kind, _, what = name.partition("_")
    return kind in ("acceleration", "pressure") and what.startswith(_OVERALL)


def _p_value(size: float, null: NDArray[np.float64]) -> float:
    """Probability of so large a difference without a cause, corrected for all stages [-]."""
    beyond = int(np.count_nonzero(null >= size))
    return min(1.0, len(STAGES) * (1.0 + beyond) / (len(null) + 1.0))


def _most(sizes: NDArray[np.float64]) -> float:
    known = sizes[np.isfinite(sizes)]
    return float(known.max()) if known.size else 0.0


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


def _conditions(table: CaseTable, posterior: Posterior, strongest: NDArray[np.int64]) -> str:
    """In which conditions it shows, if only fast or only slow ones."""
    speed = np.array([c.speed for c in table.conditions], dtype=np.float64)
    if np.unique(speed).size < 3:
        return "all"
    z = np.abs(deviations(table, posterior.names, posterior.scale)[:, strongest])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        size = np.nanmean(z, axis=1)
    middle = float(np.median(speed))
    fast, slow = size[speed >= middle].mean(), size[speed < middle]
    if not slow.size or not np.isfinite(fast):
        return "all"
    if fast > 2.0 * slow.mean():
        return f"speed_rad_s >= {middle:g}"
    if slow.mean() > 2.0 * fast:
        return f"speed_rad_s < {middle:g}"
    return "all"
