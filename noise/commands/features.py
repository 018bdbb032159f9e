"""``bushing-noise features``: recordings into a table of features."""

from __future__ import annotations

from typing import TYPE_CHECKING

from noise.commands import options as opt
from noise.commands.batch import Task, add_batch, check_batch_out, run_batch

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from pathlib import Path

    from models.recording import Recording

__all__ = ["configure", "run"]

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
    check_batch_out(options.out)
    from features import recording_feature_names, recording_features
    from noise.recordings import read_recording

    def rows(path: Path, name: str) -> tuple[list[dict[str, object]], bool]:
        recording = read_recording(path, full_scale=options.full_scale)
        pitch = _pitch(recording) if options.pitch else {}
        return [{"file": name, **recording_features(recording), **pitch}], recording.calibrated

    def error_row(name: str, message: str) -> dict[str, object]:
        return {"file": name, "error": message}

    columns = (
        "file",
        *recording_feature_names(),
        *(_PITCH_COLUMNS if options.pitch else ()),
        "error",
    )
    return run_batch(options, Task("analysing", columns, rows, error_row))


def _pitch(recording: Recording) -> dict[str, float]:
    """Pitch of the first pressure channel."""
    from features.pitch import pitch_track

    row = recording.first("pressure")
    if row is None:
        return {}
    track = pitch_track(recording.samples[row], recording.rate)
    values = (track.median, track.range, track.voiced_share)
    return dict(zip(_PITCH_COLUMNS, values, strict=True))
