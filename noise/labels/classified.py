"""Windows of a recording, classified page by page, and what is kept of them for its segments.

Of a page's hundreds of features a few tell the frequency of a segment later on; the others have
been used when the classifier has spoken, and are not kept.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from features.windows.table import HOP, LENGTH
from models.recording import REFERENCE_PRESSURE
from noise.base.label_names import LABELS
from noise.labels.frequencies import TELLING
from noise.labels.kept_frames import KeptFrames
from noise.labels.levels import CELL_RATE, sound_levels
from noise.labels.windows import FRAMES_A_HOP, Pages, columns_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from noise.classifier import Classifier
    from noise.labels.levels import CellLevels
    from noise.recordings.blocks import RecordingBlocks

__all__ = ["Classified", "at_a_condition", "classified"]

_SILENT_LEVEL = 10.0
"""Calibrated sound below it is silence [dB re 20 uPa]: below any microphone's own noise."""

_SILENT_LEVEL_DBFS = -90.0
"""Uncalibrated sound below it is silence [dBFS]: the last bit of 16."""

_SURELY = 6.0
"""What is louder than silence by so much in its described part needs no second look [dB]."""

_STRANGERS = 0.5
"""Odds of a sound that is none of the noises and no quiet where an operating condition is stated,
over those elsewhere [-]; assumed: of the recordings that the classifier learned from, a third are
such sounds."""


@dataclass(frozen=True, eq=False)
class Classified:
    """What is known of a recording once its windows are classified.

    Parameters
    ----------
    probabilities : ndarray, shape (n_windows, n_labels)
        [-]; what is silent is ``none``.
    telling : ndarray of float32, shape (n_windows, n_features)
        By `noise.labels.frequencies.FREQUENCY_NAMES` [unit of each feature].
    level, cells
        As `noise.labels.windows.Described` has them.
    frames : KeptFrames
        The same frames.
    """

    probabilities: NDArray[np.float64]
    telling: NDArray[np.float32]
    level: NDArray[np.float32]
    frames: KeptFrames
    cells: CellLevels


def classified(blocks: RecordingBlocks, classifier: Classifier) -> Classified:
    """Describe and classify all windows of a recording.

    Parameters
    ----------
    blocks : RecordingBlocks
        As for `noise.labels.windows.describe`.
    classifier : Classifier

    Returns
    -------
    Classified
    """
    asked = columns_of(classifier)
    probabilities, telling, levels, frames = [], [], [], KeptFrames()
    pages = Pages(blocks)
    for page in pages:
        probabilities.append(classifier.predict_proba(page.features[:, asked]))
        telling.append(page.features[:, TELLING])
        levels.append(page.level)
        frames.put(page.first * FRAMES_A_HOP, page.frames)
    found = Classified(
        np.concatenate(probabilities),
        np.concatenate(telling),
        np.concatenate(levels),
        frames,
        pages.cells,
    )
    if at_a_condition(blocks):
        found.probabilities[:, LABELS.index("unknown")] *= _STRANGERS
        found.probabilities[:] /= found.probabilities.sum(axis=1, keepdims=True)
    silent = _silent_windows(blocks, found)
    found.probabilities[silent] = np.eye(len(LABELS))[LABELS.index("none")]
    return found


def at_a_condition(blocks: RecordingBlocks) -> bool:
    """Whether it is of a bushing at a stated condition, where nothing else is expected to sound."""
    at = blocks.condition
    stated = (at.speed, at.interference, at.support_stiffness)
    return any(value is not None for value in stated)


def _silent_windows(blocks: RecordingBlocks, found: Classified) -> NDArray[np.bool_]:
    """Whether nothing is to be heard in each window."""
    cells, n = found.cells, len(found.level)
    row = blocks.first("pressure")
    full_scale = 1.0 if row is None else blocks.channels[row].full_scale
    silent = np.zeros(n, dtype=np.bool_)
    # All that is heard is no less than the part of it that is described.
    limit = _SILENT_LEVEL_DBFS + 20.0 * math.log10(full_scale)
    if blocks.calibrated:
        limit = _SILENT_LEVEL + 20.0 * math.log10(REFERENCE_PRESSURE)
    loud = (found.level > limit + _SURELY) & (row is not None)
    for window in np.flatnonzero(~loud).tolist():
        first = min(round(window * HOP * CELL_RATE), cells.count - 1)
        last = min(first + round(LENGTH * CELL_RATE), cells.count)
        rms = cells.rms_db(first, last)
        if rms is None or row is None:
            silent[window] = rms is None
            continue
        level, level_dbfs = sound_levels(rms, calibrated=blocks.calibrated, full_scale=full_scale)
        if level is not None:
            silent[window] = level < _SILENT_LEVEL
        else:
            silent[window] = level_dbfs is None or level_dbfs < _SILENT_LEVEL_DBFS
    return silent
