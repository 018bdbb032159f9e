"""Simulated samples kept in a file: to simulate them takes longer than to learn from them."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from models.errors import ParameterError
from models.foreign_file import read_arrays, reading
from noise.base.atomic import atomic
from noise.batch.identity import program_identity
from noise.training.classifier.described_samples import Sample

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

__all__ = ["as_line", "load_samples", "of_line", "save_samples"]


def as_line(sample: Sample) -> list[object]:
    """Return a sample as JSON can hold it.

    Examples
    --------
    >>> one = Sample(np.full((2, 3), np.float32(0.1)), "creak", False, "bushing")
    >>> bool(np.all(of_line(as_line(one)).features == one.features))
    True
    """
    return [sample.features.tolist(), sample.label, sample.ambiguous, sample.name]


def of_line(line: Sequence[Any]) -> Sample:
    """Return the sample of a line."""
    features, *said = line
    return Sample(np.array(features, dtype=np.float32), *said)


def save_samples(path: Path, call: Sequence[object], samples: Sequence[Sample]) -> None:
    """Keep samples.

    Parameters
    ----------
    path : Path
        Ends in .npz.
    call : sequence
        What decides the samples beside the program, as JSON can hold it.
    samples : sequence of Sample

    Raises
    ------
    ParameterError
        The file cannot be written.
    """
    with atomic(path) as temporary:
        np.savez_compressed(
            temporary,
            said=np.array(_said(call)),
            features=np.concatenate([sample.features for sample in samples]),
            windows=np.array([len(sample.features) for sample in samples]),
            label=np.array([sample.label for sample in samples]),
            ambiguous=np.array([sample.ambiguous for sample in samples]),
            name=np.array([sample.name for sample in samples]),
        )


def load_samples(path: Path, call: Sequence[object]) -> list[Sample] | None:
    """Return the samples of a call; None where the file has not those, or is none.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> one = Sample(np.zeros((2, 3), dtype=np.float32), "creak", False, "bushing")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_samples(Path(folder) / "kept.npz", (0, 1), [one])
    ...     (found,) = load_samples(Path(folder) / "kept.npz", (0, 1))
    ...     found.features.shape, found.label, load_samples(Path(folder) / "kept.npz", (0, 2))
    ((2, 3), 'creak', None)
    """
    try:
        with reading(path, "file of samples"):
            kept = read_arrays(path)
            if str(kept["said"]) != _said(call):
                return None
            parts = np.split(kept["features"], np.cumsum(kept["windows"])[:-1])
            told = (kept[name].tolist() for name in ("label", "ambiguous", "name"))
            return [Sample(*one) for one in zip(parts, *told, strict=True)]
    except ParameterError:  # none, or damaged
        return None


def _said(call: Sequence[object]) -> str:
    return json.dumps([program_identity(), *call])
