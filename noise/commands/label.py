"""``bushing-noise label``: recordings into a table of labelled segments."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from noise.commands import options as opt
from noise.commands.batch import Task, add_batch, check_batch_out, run_batch

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

__all__ = ["configure", "run"]


def configure(parser: ArgumentParser) -> None:
    """Declare description and options."""
    parser.description = (
        "Label recordings: one row a segment with the label creak, squawk, squeal, none or "
        "unknown, its probability, frequency in Hz and level in dB re 20 uPa (dBFS where not "
        "calibrated), and the operating condition it belongs to. A file that cannot be read has "
        "the reason in the column error."
    )
    add_batch(parser)
    parser.add_argument(
        "--classifier",
        type=Path,
        metavar="FILE.npz",
        help="classifier that `bushing-noise train` made (default: the one that is shipped)",
    )
    opt.add_full_scale(parser)
    opt.add_seed(parser, "taken by all commands; labelling uses no random numbers")


def run(options: Namespace) -> int:
    """Label and write the table."""
    check_batch_out(options.out)
    from noise.classifier import load_classifier
    from noise.labels.segments import label_recording
    from noise.labels.table import COLUMNS, error_row, label_rows
    from noise.recordings import read_recording

    classifier = load_classifier(options.classifier)

    def rows(path: Path, name: str) -> tuple[list[dict[str, object]], bool]:
        recording = read_recording(path, full_scale=options.full_scale)
        segments = label_recording(recording, classifier, per_track=_names_no_channels(path))
        return label_rows(name, recording, segments), recording.calibrated

    return run_batch(options, Task("labelling", COLUMNS, rows, error_row))


def _names_no_channels(path: Path) -> bool:
    """Whether it is a plain sound file, whose tracks stand for themselves."""
    from noise.recordings.sidecar import find_sidecar, read_sidecar

    sidecar = find_sidecar(path)
    return sidecar is None or read_sidecar(sidecar).channels is None
