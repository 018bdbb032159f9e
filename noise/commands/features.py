"""``bushing-noise features``: recordings into a table of features."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from noise.commands import options as opt
from noise.commands.batch import add_batch, check_batch, run_batch

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from pathlib import Path

    from models.recording import Recording

__all__ = ["Featuring", "configure", "run"]

_PITCH_COLUMNS = ("pressure_pitch", "pressure_pitch_range", "pressure_voiced_share")


def configure(parser: ArgumentParser) -> None:
    """Declare description and options."""
    parser.description = (
        "Compute the features of recordings: one row a recording, in SI units, levels in dB. "
        "What a recording cannot tell is empty; a file that cannot be read has the reason in the "
        "column error."
    )
    add_batch(parser)
    parser.add_argument(
        "--pitch",
        action="store_true",
        help="add the course of the pitch: median [Hz], range [octaves] and share of the time "
        "that has one, of the first pressure channel (about one second a second of sound)",
    )
    opt.add_full_scale(parser)
    opt.add_seed(parser, "taken by all commands; features use no random numbers")


def run(options: Namespace) -> int:
    """Compute the features and write the table."""
    check_batch(options)
    from noise.batch import find_jobs

    work = Featuring(options.full_scale, options.pitch)
    return run_batch(options, work, find_jobs(options.paths))


@dataclass(frozen=True)
class Featuring:
    """A `noise.batch.Work`: the features of a recording."""

    full_scale: float | None = None
    pitch: bool = False

    doing = "analysing"

    @property
    def columns(self) -> tuple[str, ...]:
        """File, features and reason of a refusal."""
        from features import recording_feature_names

        pitch = _PITCH_COLUMNS if self.pitch else ()
        return ("file", *recording_feature_names(), *pitch, "error")

    def prepare(self) -> None:
        """Load the libraries."""
        import noise.recordings  # noqa: F401

    def identity(self) -> dict[str, float | None]:
        """Return the options that decide the rows."""
        return {"full_scale": self.full_scale}

    def rows(self, path: Path, name: str) -> tuple[list[dict[str, object]], bool]:
        """Return the row of a recording, and whether it is calibrated."""
        from features import recording_features
        from noise.recordings import read_recording

        recording = read_recording(path, full_scale=self.full_scale)
        pitch = _pitch(recording) if self.pitch else {}
        return [{"file": name, **recording_features(recording), **pitch}], recording.calibrated


def _pitch(recording: Recording) -> dict[str, float]:
    """Pitch of the first pressure channel."""
    from features.kernels.pitch import pitch_track

    row = recording.first("pressure")
    if row is None:
        return {}
    track = pitch_track(recording.samples[row], recording.rate)
    values = (track.median, track.range, track.voiced_share)
    return dict(zip(_PITCH_COLUMNS, values, strict=True))
