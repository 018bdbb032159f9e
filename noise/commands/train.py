"""``bushing-noise train``: train the classifier on simulations and the user's own recordings."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from models.errors import ParameterError
from noise.base.files import check_target
from noise.base.progress import Steps, counted, report, say, steps, track
from noise.base.tables import TABLE_ENDINGS
from noise.commands.options import Option, refuse, whole_number

if TYPE_CHECKING:
    from noise.training.classifier.samples import Sample


_SCORES = ("n", "accuracy", "macro_f1", "expected_calibration_error", "strangers_named")
"""Scores of the card that are printed."""


OPTIONS = (
    Option("--out FILE.npz", Path, required=True),
    Option("--add DIR|TABLE", Path, repeated=True),
    Option("--samples N", whole_number(1)),
)


def run(options: Namespace) -> int:
    """Train and save the classifier, and print its scores."""
    if options.out.suffix.lower() != ".npz" or options.out.is_dir():
        raise ParameterError(f"--out {options.out}: a classifier is a file that ends in .npz")
    check_target(options.out)
    with steps("training", 3) as progress:
        progress("preparing")
        added, refused = _own_samples(options.add or ())
        progress("simulating training samples of the classifier")
        from noise.training.classifier.fit import N_TRAINING, train

        classifier = train(
            seed=options.seed,
            n_training=options.samples or N_TRAINING,
            added=added,
            progress=partial(_simulating, progress),
        )
        classifier.save(options.out)
    say(f"trained: {_scores(classifier.card)}")
    if added:
        say(f"own recordings: {_own_scores(classifier.card.get('own'))}")
    report(options.out)
    return int(refused)


def _own_samples(folders: Sequence[Path]) -> tuple[list[Sample], bool]:
    """Return the samples of the user's recordings, and whether files were refused."""
    if not folders:
        return [], False
    from noise.training.classifier.own_recordings import own_samples

    for folder in folders:
        is_table = folder.is_file() and folder.suffix.lower() in TABLE_ENDINGS
        if not folder.is_dir() and not is_table:
            raise ParameterError(f"--add {folder}: there is no such folder, nor label table")
    samples: list[Sample] = []
    refusals: list[str] = []
    for folder in dict.fromkeys(folder.resolve() for folder in folders):
        new_samples, refused = own_samples(folder, partial(track, doing="analysing", unit="file"))
        samples += new_samples
        refusals += refused
    for line in refusals:
        refuse(line)
    if not samples:
        raise ParameterError(
            f"--add {', '.join(map(str, folders))}: holds no recording with a label that can be "
            "learned from"
        )
    return samples, bool(refusals)


def _simulating(progress: Steps, samples: Iterable[Sample], total: int) -> Iterable[Sample]:
    """Show the progress of the samples, and name the step that follows them."""
    yield from track(samples, "simulating", total=total, unit="training sample")
    progress("growing trees, and scoring them on what they have not learned, for some minutes")


def _scores(card: Mapping[str, object]) -> str:
    """Return the scores of a classifier as text."""
    parts = []
    for name in ("pressure", "three_channels"):
        scores = card.get(f"{name}_kinds_left_out")
        if isinstance(scores, dict):
            numbers = ", ".join(
                f"{key.replace('_', ' ')} {scores[key]:g}" for key in _SCORES if key in scores
            )
            parts.append(f"{name.replace('_', ' ')}: {numbers}")
    return "; ".join(parts) or "no score"


def _own_scores(card: object) -> str:
    """Return the scores on the user's own recordings as text."""
    if not isinstance(card, dict):
        return "none"
    parts = [f"{counted(card['files'], 'file')}, each scored by trees grown without it"]
    for label, scores in card["labels"].items():
        of = counted(scores["files"], "file")
        recall = f"recall {scores['recall']:.0%} in {of}, " if scores["stretches"] else ""
        named = counted(scores["false_names"], "time")
        parts.append(f"{label}: {recall}named {named} in something else")
    return "; ".join(parts)
