"""What was simulated for a comparison, known for the rest of a call and, on disk, for the next."""

from __future__ import annotations

import hashlib
from collections import UserDict
from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError

if TYPE_CHECKING:
    from noise.batch.lines import Results

__all__ = ["KeptArrays"]


class KeptArrays(UserDict[tuple[object, ...], NDArray[np.float64]]):
    """Arrays of floats by what they were made of.

    Parameters
    ----------
    about : str
        What decides them beside their keys, such as a digest of the rig.
    kept : Results, optional
        Where they are kept besides, and what an earlier call found.

    Examples
    --------
    >>> arrays = KeptArrays("rig")
    >>> arrays["model", 5.0] = np.ones(2)
    >>> arrays["model", 5.0].tolist(), ("model", 1.0) in arrays
    ([1.0, 1.0], False)
    """

    def __init__(self, about: str, kept: Results | None = None) -> None:
        super().__init__()
        self._about, self._kept = about, kept
        self._found = {} if kept is None else kept.found

    def __missing__(self, key: tuple[object, ...]) -> NDArray[np.float64]:
        self.data[key] = np.array(self._found[self._name(key)], dtype=np.float64)
        return self.data[key]

    def __contains__(self, key: object) -> bool:
        return key in self.data or self._name(key) in self._found

    def __setitem__(self, key: tuple[object, ...], array: NDArray[np.float64]) -> None:
        self.data[key] = array
        if self._kept is not None:
            # Who simulates would take a full disk for a model that cannot be simulated.
            with suppress(ParameterError):
                self._kept.add(self._name(key), *array.tolist())

    def _name(self, key: object) -> str:
        return hashlib.sha256(f"{self._about} {key!r}".encode()).hexdigest()
