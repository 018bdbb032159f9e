"""Held-out recordings beside simulations of them, to be seen and heard."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from models.recording import Recording
from noise.diagnosis.evidence.friction_curves import friction_curves
from noise.diagnosis.findings import Illustration, LabelsAndLevels
from noise.diagnosis.fit.labels_and_levels import labels_and_levels
from noise.diagnosis.simulated.model_runs import Model, ModelRuns

if TYPE_CHECKING:
    from noise.diagnosis.case import Case
    from noise.diagnosis.fit.case_comparison import CaseComparison

    Simulated = Callable[[Recording], Recording]


_DRAWN, _HEARD = 2, 3
"""Held-out recordings that are drawn, and that are listened to."""

_SEED = 7


def simulated_by(runs: ModelRuns | CaseComparison, model: Model | None = None) -> Simulated:
    """Return how a recording is simulated by a model, by default the rig as it is."""
    return lambda recording: runs.simulated(model or Model(), recording, _SEED)


def illustrations_of(
    case: Case, held: Sequence[int], before: Simulated, after: Simulated | None = None
) -> tuple[Illustration, ...]:
    """Show held-out recordings beside the nominal model, and beside what was found.

    Parameters
    ----------
    case : Case
    held : sequence of int
        These recordings.
    before, after : callable
        Simulate a recording.
    """
    return tuple(_illustration(case, i, before, after) for i in held[:_DRAWN])


def heard_of(
    case: Case, held: Sequence[int], before: Simulated, after: Simulated
) -> tuple[LabelsAndLevels, ...]:
    """Listen to held-out recordings and to simulations of them.

    Parameters
    ----------
    case, held, before, after
        As of `illustrations_of`.
    """
    return tuple(
        labels_and_levels(
            case.names[i], case.recordings[i], before(case.recordings[i]), after(case.recordings[i])
        )
        for i in held[:_HEARD]
    )


def _illustration(case: Case, i: int, before: Simulated, after: Simulated | None) -> Illustration:
    measured = case.recordings[i]
    shown = {"measured": measured, "before": before(measured)}
    if after is not None:
        shown["after"] = after(measured)
    found = {name: friction_curves(recording, case.rig) for name, recording in shown.items()}
    contacts = {name: curves for name, curves in found.items() if curves is not None}
    return Illustration(case.names[i], measured, shown["before"], shown.get("after"), contacts)
