"""Simulated samples kept in a file: to simulate them takes longer than to learn from them."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from functools import cache
from importlib.metadata import version
from pathlib import Path

import numpy as np

from models.errors import ParameterError
from models.foreign_file import read_arrays, reading
from noise.base.files import atomic
from noise.training.classifier.described_samples import Sample

_PACKAGES = ("models", "sim", "features", "noise")
_LIBRARIES = ("librosa", "numba", "numpy", "scikit-learn", "scipy", "soundfile")
"""What the samples come from."""


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
    return json.dumps([_program(), *call])


@cache  # a process goes on with the program that it has loaded
def _program() -> str:
    """Digest of the program's sources and models, and of the libraries' versions."""
    digest, root = hashlib.sha256(), Path(__file__).parents[3]
    for library in _LIBRARIES:
        digest.update(f"{library} {version(library)}\n".encode())
    for path in sorted(one for package in _PACKAGES for one in (root / package).rglob("*")):
        if path.is_file() and path.parent.name != "__pycache__":
            digest.update(path.relative_to(root).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()
