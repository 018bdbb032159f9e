"""Conditions of a stretch of a recording, from about its middle."""

from __future__ import annotations

from typing import TYPE_CHECKING

from features.registry import recording_features
from noise.inference.described import KINDS
from noise.inference.hearing import RATES
from noise.inference.model import Inferred
from noise.training.inference.population import LONGEST_LOOK, MATERIAL, SHORTEST_LOOK

if TYPE_CHECKING:
    from models.condition import Condition
    from noise.inference.model import Inference
    from noise.recordings.blocks import RecordingBlocks

__all__ = ["infer_stretch"]


def infer_stretch(
    blocks: RecordingBlocks, first: int, last: int, logged: Condition, inference: Inference
) -> Inferred:
    """Infer what is not logged of a stretch that creaks, squawks or squeals.

    Parameters
    ----------
    blocks : RecordingBlocks
    first, last : int
        The stretch from sample `first` up to `last`; of a longer one than 1 s the middle is
        looked at.
    logged : Condition
    inference : Inference

    Returns
    -------
    Inferred
        As `Inference.infer` gives it; nothing where the recording is none of those that the
        intervals hold for: shorter, sampled more slowly, or of another material.

    Examples
    --------
    >>> from models.condition import Condition
    >>> from models.rig_files.rig_file import load_material_rig
    >>> from noise.inference import load_inference
    >>> from noise.recordings.blocks import RecordingBlocks
    >>> from sim.run import simulate
    >>> run = simulate(load_material_rig("fluorocarbon"), 1.0, interference=0.381e-3)
    >>> blocks = RecordingBlocks.of(run.recording)
    >>> found = infer_stretch(blocks, 0, blocks.n_samples, Condition(), load_inference())
    >>> found["interference"].low < 0.381e-3 < found["interference"].high
    True
    """
    kinds = [kind for kind in KINDS if blocks.first(kind) is not None]
    if not kinds or blocks.rate < min(RATES) or last - first < SHORTEST_LOOK * blocks.rate:
        return Inferred()
    if (logged.material or MATERIAL).lower() != MATERIAL:
        return Inferred()
    spare = max(0, last - first - round(LONGEST_LOOK * blocks.rate))
    look = blocks.cut(first + spare // 2, last - (spare - spare // 2))
    return inference.infer(
        recording_features(look), logged, kinds=kinds, calibrated=blocks.calibrated
    )
