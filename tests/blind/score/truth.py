"""What was the matter with a case, read from its answer.

`gap` is the distance, in floors, between recordings with and without what is the matter (1 being
repeats of each other); `alone` the same for each effect by itself; `closed` the share of the
closable gap that goes when the effect is turned off: 1 where the plain rig is the nominal one.
Where an answer has floors, as `floors` adds them, its gap is theirs.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["LEAST_GAP", "SPECIAL", "Truth", "read_truths", "truth_of"]

LEAST_GAP = 1.5
"""Above so many floors a case counts for all but false alarms."""

SPECIAL = ("none", "parameters", "unknown")
"""What a verdict can say beside effects."""


@dataclass(frozen=True)
class Truth:
    """The truth of one case; `verdict` as a perfect diagnosis has it."""

    case: str
    kind: str
    verdict: tuple[str, ...]
    stages: tuple[str, ...] = ()
    strength: float | None = None
    gap: float | None = None
    alone: dict[str, float] = field(default_factory=dict)
    closed: float = 1.0
    bench: str = "quiet"

    @property
    def names(self) -> tuple[str, ...]:
        """Names that are true of the case; ``none`` where nothing is the matter."""
        return self.verdict or ("none",)

    @property
    def counts(self) -> bool:
        """Whether the gap is large enough for what is asked beside false alarms."""
        return self.kind != "none" and (self.gap is None or self.gap > LEAST_GAP)


def truth_of(case: str, answer: dict) -> Truth:
    """Take the truth from an answer as the generator writes it."""
    effects = answer["effects"]
    return Truth(
        case,
        answer["class"],
        tuple(answer["verdict"]),
        tuple(effect["stage"] for effect in effects),
        effects[0]["strength"] if len(effects) == 1 else None,
        answer.get("floors", answer.get("gap")),
        answer.get("gap_alone", {}),
        answer.get("closed", 1.0),
        answer.get("bench", "quiet"),
    )


def read_truths(folder: Path) -> list[Truth]:
    """Read a folder of answers, in the order of their names."""
    paths = sorted(folder.glob("*.json"))
    if not paths:
        raise SystemExit(f"{folder} holds no answers")
    return [truth_of(path.stem, json.loads(path.read_text(encoding="utf-8"))) for path in paths]
