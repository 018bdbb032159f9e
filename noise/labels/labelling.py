"""Labelling as work that is done with each recording of a batch, here or in other processes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from noise.batch.identity import file_digest
from noise.classifier import load_classifier
from noise.inference import load_inference
from noise.labels.segments import label_recording
from noise.labels.table import COLUMNS, label_rows
from noise.recordings import read_recording
from noise.recordings.blocks import open_blocks
from noise.recordings.sidecar import find_sidecar, read_sidecar

if TYPE_CHECKING:
    from pathlib import Path

    from noise.classifier import Classifier
    from noise.inference import Inference

__all__ = ["Labelling", "names_no_channels"]


@dataclass(frozen=True)
class Labelling:
    """A `noise.batch.Work`: the labelled segments of a recording.

    Parameters
    ----------
    classifier, inference : Path, optional
        Files that ``bushing-noise train`` made; by default those that are shipped.
    full_scale : float, optional
        Sound pressure of a full-scale sample [Pa], for sound files that do not say it.

    Examples
    --------
    >>> Labelling().columns[:3]
    ('file', 'channel', 'start_s')
    """

    classifier: Path | None = None
    inference: Path | None = None
    full_scale: float | None = None

    doing = "labelling"

    @property
    def columns(self) -> tuple[str, ...]:
        """Of the label table."""
        return COLUMNS

    def prepare(self) -> None:
        """Load the classifier and, where the user names one, what infers conditions."""
        _ = self._loaded, self._inference

    def identity(self) -> dict[str, str | float | None]:
        """Return what decides the rows: the options, and the models by their content."""
        # The shipped ones are part of the program.
        models = {"classifier": self.classifier, "inference": self.inference}
        said: dict[str, str | float | None] = {"full_scale": self.full_scale}
        for name, path in models.items():
            said[name] = None if path is None else file_digest(path)
        return said

    def rows(self, path: Path, name: str) -> tuple[list[dict[str, object]], bool]:
        """Return the rows of a recording, and whether it is calibrated."""
        with open_blocks(path, full_scale=self.full_scale) as blocks:
            recording = blocks or read_recording(path, full_scale=self.full_scale)
            segments = label_recording(recording, self._loaded, per_track=names_no_channels(path))
            rows = label_rows(name, recording, segments, self._inference)
            return rows, recording.calibrated

    @cached_property
    def _loaded(self) -> Classifier:
        return load_classifier(self.classifier)

    @cached_property
    def _inference(self) -> Inference | None:
        # The shipped one is loaded by the first noise whose condition is not logged.
        return None if self.inference is None else load_inference(self.inference)

    def __getstate__(self) -> dict[str, object]:
        """Leave the loaded models here: elsewhere they are loaded again."""
        return {
            "classifier": self.classifier,
            "inference": self.inference,
            "full_scale": self.full_scale,
        }


def names_no_channels(path: Path) -> bool:
    """Whether it is a plain sound file, whose tracks stand for themselves."""
    sidecar = find_sidecar(path)
    return sidecar is None or read_sidecar(sidecar).channels is None
