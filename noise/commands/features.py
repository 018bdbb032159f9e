"""``bushing-noise features``: recordings into a table of features."""

from __future__ import annotations

from argparse import Namespace
from dataclasses import dataclass
from pathlib import Path

from noise.base.progress import note
from noise.commands.batch import BATCH, run_batch
from noise.commands.options import CALIBRATION, full_scale_of

OPTIONS = (*BATCH, *CALIBRATION)


def run(options: Namespace) -> int:
    """Compute the features and write the table."""
    from noise.batch.work import find_jobs

    work = FeatureExtraction(full_scale_of(options))
    return run_batch(options, work, find_jobs(options.paths))


@dataclass(frozen=True)
class FeatureExtraction:
    """`noise.batch.work.Work` that computes the features of a recording.

    Parameters
    ----------
    full_scale : float, optional
        Sound pressure of a full-scale sample [Pa], for sound files that do not state it.
    """

    full_scale: float | None = None

    doing = "analysing"

    @property
    def columns(self) -> tuple[str, ...]:
        """File, features and error."""
        from features import recording_feature_names

        return ("file", *recording_feature_names(), "error")

    def prepare(self) -> None:
        """Import the libraries."""
        import noise.recordings  # noqa: F401

    def identity(self) -> dict[str, object]:
        """Return the options on which the rows depend."""
        return {"full_scale": self.full_scale}

    def rows(self, path: Path, name: str) -> tuple[list[dict[str, object]], bool]:
        """Return the row of a recording, and whether it is calibrated."""
        from features import recording_features
        from features.table import piece_count
        from noise.recordings.files import open_blocks

        with open_blocks(path, full_scale=self.full_scale) as blocks:
            if (pieces := piece_count(blocks.n_samples)) > 1:
                length = blocks.n_samples / pieces / blocks.rate
                note(
                    f"{name}: its features are computed in {pieces} pieces of {length:.3g} s and "
                    "averaged by power"
                )
            return [{"file": name, **recording_features(blocks)}], blocks.calibrated
