"""Labelling of recordings: a row for each segment, linked to the condition it was recorded at.

What was logged stands as it is. What was not is inferred where there is a noise to tell it, with
the bounds of an interval of 90 %; the material is never. The intervals are those of a fluorocarbon
bushing like the shipped one: a recording of another material has none, nor has a sound that nothing
says to be of a rig. The work on a recording can be done here or in other processes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

from noise.base.label_names import LABELS, NAMED
from noise.batch.identity import file_digest
from noise.classifier import load_classifier
from noise.labels.label_display import ASSUMED, assumes_material
from noise.labels.loudness import with_loudness
from noise.labels.segment_speed import segment_speed, speed_remark
from noise.labels.segments import label_recording
from noise.recordings import read_recording
from noise.recordings.blocks import RecordingBlocks, open_blocks
from noise.recordings.files import names_channels

if TYPE_CHECKING:
    from pathlib import Path

    from models.condition import Condition
    from models.recording import Recording
    from noise.classifier import Classifier
    from noise.inference import Inference, Interval
    from noise.labels.segments import Segment
    from noise.recordings.meaning import PascalPerFullScale

__all__ = [
    "COLUMNS",
    "CONDITIONS",
    "SEGMENT_COLUMNS",
    "Labelling",
    "label_rows",
    "labelled_tracks",
    "segment_cells",
]

_DIGITS = 4
"""Of what is inferred, which is known to far fewer."""

CONDITIONS = {
    "speed_rad_s": "speed",
    "interference_mm": "interference",
    "support_stiffness_Nm_rad": "support_stiffness",
}
"""Columns, and the fields of a condition that they hold."""

SEGMENT_COLUMNS = (
    "channel", "start_s", "end_s", "label",
    *(f"p_{label}" for label in LABELS),
    "frequency_hz", "level_db", "level_dba", "l_afmax_dba", "loudness_n5_sone", "snr_dba",
    "level_dbfs",
)  # fmt: skip
"""What a segment says by itself."""

COLUMNS = (
    "file", *SEGMENT_COLUMNS, "calibrated",
    *(f"{name}{part}" for name in CONDITIONS for part in ("", "_low", "_high", "_source")),
    "material", "material_source", "label_source", "note", "error",
)  # fmt: skip
"""Columns of the table, all of them always there."""


@dataclass(frozen=True)
class Labelling:
    """A `noise.batch.Work`: the labelled segments of a recording.

    Parameters
    ----------
    classifier, inference : Path, optional
        Files that ``bushing-noise train`` made; by default those that are shipped.
    full_scale : float or tuple of float, optional
        Sound pressure of a full-scale sample [Pa], for sound files that do not say it.
    sensitivity : float
        Odds at which a noise is named, over the classifier's own [ratio].
    loudness : bool
        Whether the loudness N5 of each segment is told as well.

    Examples
    --------
    >>> Labelling().columns[:3]
    ('file', 'channel', 'start_s')
    """

    classifier: Path | None = None
    inference: Path | None = None
    full_scale: PascalPerFullScale | None = None
    sensitivity: float = 1.0
    loudness: bool = False

    doing = "labelling"

    @property
    def columns(self) -> tuple[str, ...]:
        """Of the label table."""
        return COLUMNS

    def prepare(self) -> None:
        """Load the classifier and, where the user names one, what infers conditions."""
        if self.loudness:
            from features.sound_quality import check_available

            check_available()
        _ = self._loaded, self._inference

    def identity(self) -> dict[str, object]:
        """Return what decides the rows: the options, and the models by their content."""
        # The shipped ones are part of the program.
        models = {"classifier": self.classifier, "inference": self.inference}
        said: dict[str, object] = {
            "full_scale": self.full_scale,
            "sensitivity": self.sensitivity,
            "loudness": self.loudness,
        }
        for name, path in models.items():
            said[name] = None if path is None else file_digest(path)
        return said

    def false_names_an_hour(self) -> tuple[dict[float, float], float]:
        """Return what the card counted, by sensitivity [1/h], and in how much sound [h].

        Empty where it counted nothing.
        """
        counted = self._loaded.card.get("real_sources_left_out")
        if not isinstance(counted, dict):
            return {}, 0.0
        found = {float(s): float(n) for s, n in counted["false_names_an_hour"].items()}
        return found, float(counted["background_hours"])

    def rows(self, path: Path, name: str) -> tuple[list[dict[str, object]], bool]:
        """Return the rows of a recording, and whether it is calibrated."""
        with open_blocks(path, full_scale=self.full_scale) as blocks:
            recording = blocks or read_recording(path, full_scale=self.full_scale)
            segments = label_recording(recording, self._loaded, per_track=not names_channels(path))
            if self.loudness:
                segments = with_loudness(RecordingBlocks.of(recording), segments)
            rows = label_rows(name, recording, segments, self._inference)
            return rows, recording.calibrated

    @cached_property
    def _loaded(self) -> Classifier:
        return load_classifier(self.classifier).sensitive(self.sensitivity)

    @cached_property
    def _inference(self) -> Inference | None:
        # The shipped one is loaded by the first noise whose condition is not logged.
        if self.inference is None:
            return None
        from noise.inference import load_inference

        return load_inference(self.inference)

    def __getstate__(self) -> dict[str, object]:
        """Leave the loaded models here: elsewhere they are loaded again."""
        return {
            "classifier": self.classifier,
            "inference": self.inference,
            "full_scale": self.full_scale,
            "sensitivity": self.sensitivity,
            "loudness": self.loudness,
        }


def labelled_tracks(path: Path, n_channels: int) -> list[str]:
    """Return what of a recording has labels of its own, as the column ``channel`` names it.

    Examples
    --------
    >>> from pathlib import Path
    >>> labelled_tracks(Path("stereo.wav"), 2), labelled_tracks(Path("mono.wav"), 1)
    (['1', '2'], ['all'])
    """
    several = n_channels > 1 and not names_channels(path)
    return [str(number + 1) for number in range(n_channels)] if several else ["all"]


def label_rows(
    name: str,
    recording: Recording | RecordingBlocks,
    segments: list[Segment],
    inference: Inference | None = None,
) -> list[dict[str, object]]:
    """Return one row for each segment.

    Parameters
    ----------
    name : str
        File as found, relative to the folder named.
    recording : Recording or RecordingBlocks
        Where the shaft's speed was recorded, each segment gets its mean over that segment.
    segments : list of Segment
    inference : Inference, optional
        By which conditions that were not logged are inferred; by default the one that is shipped.

    Returns
    -------
    list of dict
        By `COLUMNS`; a condition's source is ``logged``, ``inferred`` or ``missing``, and it has
        bounds where it is inferred. An inferred speed is a magnitude. The bolted clamp's support
        stiffness is ``inf``.

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel, Recording
    >>> from noise.labels.segments import Segment
    >>> turning = Recording(np.array([[0.0, 1.0, 2.0, 3.0]]), 2.0, (Channel("angle"),))
    >>> part = Segment("all", 0.0, 2.0, "none", dict.fromkeys(LABELS, 0.2), None, None, None)
    >>> row, = label_rows("run07.wav", turning, [part])
    >>> row["speed_rad_s"], row["speed_rad_s_source"], row["material_source"]
    (2.0, 'logged', 'missing')
    """
    blocks = RecordingBlocks.of(recording)
    return [_row(name, blocks, segment, inference) for segment in segments]


def segment_cells(segment: Segment) -> dict[str, object]:
    """Return what a segment says by itself, by `SEGMENT_COLUMNS`.

    Examples
    --------
    >>> from noise.labels.segments import Segment
    >>> quiet = Segment("all", 0.0, 2.0, "none", {"none": 0.9}, None, 31.234, None)
    >>> segment_cells(quiet)["level_db"]
    31.23
    """
    return {
        "channel": segment.channel,
        "start_s": round(segment.start, 6),
        "end_s": round(segment.end, 6),
        "label": segment.label,
        **{f"p_{label}": round(p, 6) for label, p in segment.probabilities.items()},
        "frequency_hz": _rounded(segment.frequency, 2),
        "level_db": _rounded(segment.level, 2),
        "level_dba": _rounded(segment.level_a, 2),
        "l_afmax_dba": _rounded(segment.level_af_max, 2),
        "loudness_n5_sone": _rounded(segment.loudness_n5, 4),
        "snr_dba": _rounded(segment.snr, 2),
        "level_dbfs": _rounded(segment.level_dbfs, 2),
    }


def _row(
    name: str, blocks: RecordingBlocks, segment: Segment, inference: Inference | None
) -> dict[str, object]:
    speed = segment_speed(blocks, segment.start, segment.end)
    condition = replace(blocks.condition, speed=speed)
    row: dict[str, object] = {
        **dict.fromkeys(COLUMNS),
        "file": name,
        **segment_cells(segment),
        "calibrated": blocks.calibrated,
        "material": condition.material,
        "material_source": "logged" if condition.material else "missing",
        "label_source": "classifier",
    }
    inferred = _inferred(blocks, segment, condition, inference)
    for column, field in CONDITIONS.items():
        value = _in_unit(column, getattr(condition, field))
        row[column] = value
        row[f"{column}_source"] = "missing" if value is None else "logged"
        if value is None and field in inferred:
            interval = inferred[field]
            row[column] = _inferred_in_unit(column, interval.value)
            row[f"{column}_low"] = _inferred_in_unit(column, interval.low)
            row[f"{column}_high"] = _inferred_in_unit(column, interval.high)
            row[f"{column}_source"] = "inferred"
    assumed = f"conditions inferred {ASSUMED}" if assumes_material(row) else ""
    remarks = [text for text in (speed_remark(blocks, speed), assumed) if text]
    row["note"] = "; ".join(remarks) or None
    return row


def _inferred(
    blocks: RecordingBlocks, segment: Segment, logged: Condition, inference: Inference | None
) -> dict[str, Interval]:
    """Infer what is not logged of a segment whose label tells of it."""
    unknown = any(getattr(logged, field) is None for field in CONDITIONS.values())
    if not unknown or segment.label not in NAMED:
        return {}
    # Who names a model says by it which rig the recordings are of.
    if inference is None and not _is_of_a_rig(blocks):
        return {}
    from noise.inference import infer_stretch, load_inference

    if segment.channel != "all":
        blocks = blocks.track(int(segment.channel) - 1)
    first = round(segment.start * blocks.rate)
    last = min(round(segment.end * blocks.rate), blocks.n_samples)
    return infer_stretch(blocks, first, last, logged, inference or load_inference())


def _is_of_a_rig(blocks: RecordingBlocks) -> bool:
    """Whether anything says so: another channel than sound, or a condition.

    A calibration says how loud a sound is, not what made it.
    """
    at = blocks.condition
    stated = (at.material, at.speed, at.interference, at.support_stiffness)
    others = any(channel.kind != "pressure" for channel in blocks.channels)
    return others or any(value is not None for value in stated)


def _in_unit(column: str, value: float | None) -> float | None:
    """Return a value in the unit of its column."""
    millimetres = value is not None and column.endswith("_mm")
    return _rounded(1e3 * value if millimetres and value is not None else value, 6)


def _inferred_in_unit(column: str, value: float) -> float | None:
    """Return it with as many digits as it is known to: 3745, not 3744.9998."""
    found = _in_unit(column, value)
    return None if found is None else float(f"{found:.{_DIGITS}g}")


def _rounded(value: float | None, digits: int) -> float | None:
    return None if value is None or math.isnan(value) else round(value, digits)
