"""``bushing-noise features``: recordings into a table of features per recording or window."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from noise.base.progress import note
from noise.commands.batch import BATCH, PLOT, check_batch, check_plots, draw_recordings, run_batch
from noise.commands.options import CALIBRATION, Option, full_scale_of

if TYPE_CHECKING:
    from models.blocks import RecordingBlocks
    from noise.recordings.interpretation import PascalPerFullScale


OPTIONS = (
    *BATCH,
    Option("--windows"),
    PLOT,
    *CALIBRATION,
)


def run(options: Namespace) -> int:
    """Compute the features and write the table."""
    check_batch(options)
    from noise.batch.work import find_jobs

    work = FeatureExtraction(full_scale_of(options), options.windows)
    jobs = find_jobs(options.paths)
    check_plots(options.plot, jobs)
    return run_batch(
        options, work, jobs,
        export=lambda _: draw_recordings(options.plot, jobs, full_scale=work.full_scale),
    )  # fmt: skip


@dataclass(frozen=True)
class FeatureExtraction:
    """`noise.batch.work.Work` that computes the features of a recording or of its windows.

    Parameters
    ----------
    full_scale : float or tuple of float, optional
        Sound pressure of a full-scale sample [Pa], for sound files that do not state it.
    windows : bool
        Whether to compute the classifier's features of windows.
    """

    full_scale: PascalPerFullScale | None = None
    windows: bool = False

    doing = "analysing"

    @property
    def columns(self) -> tuple[str, ...]:
        """File, for windows also channel and time, then the features and the error."""
        if self.windows:
            from noise.labels.windows import FEATURE_NAMES

            return ("file", "channel", "start_s", "end_s", *FEATURE_NAMES, "error")
        from features import recording_feature_names

        return ("file", *recording_feature_names(), "error")

    def prepare(self) -> None:
        """Import the libraries."""
        import noise.recordings  # noqa: F401

    def identity(self) -> dict[str, object]:
        """Return the options on which the rows depend."""
        return {"full_scale": self.full_scale}

    def rows(self, path: Path, name: str) -> tuple[Iterable[dict[str, object]], bool]:
        """Return the rows of a recording, and whether it is calibrated."""
        from noise.recordings.files import open_blocks

        if self.windows:
            with ExitStack() as stack:
                blocks = stack.enter_context(open_blocks(path, full_scale=self.full_scale))
                return _windows(path, name, blocks, stack.pop_all()), blocks.calibrated
        with open_blocks(path, full_scale=self.full_scale) as blocks:
            from features import recording_features
            from features.recording import piece_count

            if (pieces := piece_count(blocks.n_samples)) > 1:
                length = blocks.n_samples / pieces / blocks.rate
                note(
                    f"{name}: its features are computed in {pieces} pieces of {length:.3g} s and "
                    "averaged by power"
                )
            return [{"file": name, **recording_features(blocks)}], blocks.calibrated


def _windows(
    path: Path, name: str, recording: RecordingBlocks, opened: ExitStack
) -> Iterator[dict[str, object]]:
    """Yield the rows of the windows of a recording, and close it afterwards."""
    from features.windows.table import HOP, LENGTH
    from models.errors import ParameterError
    from noise.labels.windows import FEATURE_NAMES, WindowPages, has_window_channel, tracks
    from noise.recordings.files import names_channels

    with opened:
        for channel, track in tracks(recording, per_track=not names_channels(path)):
            if not has_window_channel(track):
                raise ParameterError(
                    f"{path}: has no channel of pressure, acceleration or torque sampled at 1000 "
                    "Hz or more, so that no window can be described"
                )
            for page in WindowPages(track):
                for i, values in enumerate(page.features.tolist(), start=page.first):
                    end = round(min(i * HOP + LENGTH, track.n_samples / track.rate), 6)
                    place = {"file": name, "channel": channel, "start_s": i * HOP, "end_s": end}
                    yield place | dict(zip(FEATURE_NAMES, values, strict=True))
