"""``bushing-noise train``: the classifier again, from simulation and the user's own recordings."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from models.errors import ParameterError
from noise.base.files import check_target
from noise.base.progress import Steps, counted, report, say, steps, track
from noise.base.tables import TABLE_ENDINGS
from noise.commands.options import SEED, Option, refuse, whole_number

if TYPE_CHECKING:
    from noise.classifier import Classifier
    from noise.training.classifier.own_samples import OwnSample

    _Sample = TypeVar("_Sample")


_PART_TO_SCORE = 5
"""With --samples N, one for so many of them is drawn to score."""

_TOLD = ("n", "accuracy", "macro_f1", "expected_calibration_error", "strangers_named")
"""Scores that are told."""


OPTIONS = (
    Option("--out FILE.npz", Path, required=True),
    Option("--add DIR|TABLE", Path, repeated=True),
    Option("--samples N", whole_number(1)),
    Option("--inference FILE.npz", Path),
    SEED,
)


def run(options: Namespace) -> int:
    """Train, save, and tell the score."""
    for path, option, what in (
        (options.out, "--out", "a classifier"),
        (options.inference, "--inference", "a model"),
    ):
        if path is not None and (path.suffix.lower() != ".npz" or path.is_dir()):
            raise ParameterError(f"{option} {path}: {what} is a file that ends in .npz")
        if path is not None:
            check_target(path, option)
    if options.inference is not None and options.inference.absolute() == options.out.absolute():
        raise ParameterError(
            f"--inference {options.inference}: is what --out names for the classifier; give one of "
            "them another name"
        )
    with steps("training", 3 if options.inference is None else 5) as tell:
        tell("preparing")
        added, refused = _own(options.add or ())
        tell("simulating what to learn from")
        classifier = _trained(options, added, tell)
        classifier.save(options.out)
        if options.inference is not None:
            from noise.training.inference.fit import train_inference

            tell("simulating what to infer from")
            model = train_inference(seed=options.seed, progress=partial(_inferring, tell))
            model.save(options.inference)
    say(f"trained: {_scores(classifier.card)}")
    if added:
        say(f"own recordings: {_own_scores(classifier.card.get('own'))}")
    report(options.out)
    if options.inference is not None:
        report(options.inference)
    return int(refused)


def _trained(options: Namespace, added: Sequence[OwnSample], tell: Steps) -> Classifier:
    from noise.training.classifier.fit import N_TEST, N_TRAINING, train

    n = options.samples
    return train(
        seed=options.seed,
        n_training=n or N_TRAINING,
        n_test=max(1, n // _PART_TO_SCORE) if n else N_TEST,
        added=added,
        progress=_simulating,
        growing=partial(_growing, tell),
    )


def _own(folders: Sequence[Path]) -> tuple[list[OwnSample], bool]:
    """Return the user's own samples, and whether something was refused, which is then named."""
    if not folders:
        return [], False
    from noise.training.classifier.own_recordings import read_labelled
    from noise.training.classifier.own_samples import own_samples

    for folder in folders:
        is_table = folder.is_file() and folder.suffix.lower() in TABLE_ENDINGS
        if not folder.is_dir() and not is_table:
            raise ParameterError(f"--add {folder}: there is no such folder, nor label table")
    samples: list[OwnSample] = []
    refusals: list[str] = []
    for folder in dict.fromkeys(folder.resolve() for folder in folders):
        windows, unread = read_labelled(folder)
        found, unlearned = own_samples(track(windows, "analysing", unit="window"))
        samples += found
        refusals += [*unread, *unlearned]
    for line in refusals:
        refuse(line)
    if not samples:
        raise ParameterError(
            f"--add {', '.join(map(str, folders))}: holds no recording with a label that can be "
            "learned from"
        )
    return samples, bool(refusals)


def _simulating(samples: Iterable[_Sample], total: int) -> Iterable[_Sample]:
    return track(samples, "simulating", total=total, unit="training sample")


def _inferring(tell: Steps, samples: Iterable[_Sample], total: int) -> Iterable[_Sample]:
    yield from _simulating(samples, total)
    tell("growing trees that infer conditions")


def _growing(tell: Steps, fits: Iterable[int], total: int) -> Iterable[int]:
    tell("growing trees, and scoring them by what they have not seen")
    yield from track(fits, "growing trees", total=total, unit="fit")


def _scores(card: Mapping[str, object]) -> str:
    parts = []
    for name in ("pressure", "three_channels"):
        found = card.get(name)
        if isinstance(found, dict):
            numbers = ", ".join(
                f"{key.replace('_', ' ')} {found[key]:g}" for key in _TOLD if key in found
            )
            parts.append(f"{name.replace('_', ' ')}: {numbers}")
    return "; ".join(parts) or "no score"


def _own_scores(card: object) -> str:
    if not isinstance(card, dict):
        return "none"
    told = [
        f"{counted(card['files'], 'file')}, each scored by trees grown without it (in brackets: by "
        "trees grown without any of them)"
    ]
    for label, found in card["labels"].items():
        if not found["windows"]:
            told.append(f"{label} said {counted(found['false_names'], 'time')} of something else")
            continue
        few = "" if found["enough"] else ", too few files to tell"
        told.append(
            f"{label}: {counted(found['windows'], 'window')} of {counted(found['files'], 'file')}, "
            f"found {found['recall']:.0%} ({found['recall_before']:.0%}), "
            f"said {counted(found['false_names'], 'time')} of something else "
            f"({found['false_names_before']}){few}"
        )
    return "; ".join(told)
