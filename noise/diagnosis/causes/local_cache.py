"""Local cases kept on disk, so that a second diagnosis of a rig starts from the first.

One small file holds what the posterior says of the cases of one rig at its conditions; its name is
a digest of all that decides that: rig, runs, posterior, and the version of results. What cannot be
read is made again, what cannot be written is not kept, and the oldest files go.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from platformdirs import user_cache_path

from models.errors import ParameterError
from noise.base.model_file import ModelKind, load_model, save_model

if TYPE_CHECKING:
    from noise.diagnosis.causes.posterior import Posterior

    Known = dict[tuple[frozenset[str], int], NDArray[np.float64]]


_KIND = ModelKind("local cases", 1, "bushing-noise diagnose", ("", ""))

_MOST = 200
"""Files that are kept; one takes a few ten kilobytes."""


@dataclass(frozen=True)
class LocalCache:
    """File of the local cases of a rig.

    Parameters
    ----------
    path : Path
    """

    path: Path

    @classmethod
    def of(cls, decisive: tuple[object, ...], posterior: Posterior) -> LocalCache | None:
        """Return the file of what is decided by these; None where there is no folder for it.

        Parameters
        ----------
        decisive : tuple
            Whatever the cases depend on beside the program and the posterior.
        posterior : Posterior
        """
        from joblib import hash as digest

        from noise.batch.journal import RESULTS_VERSION

        learned = (posterior.names, posterior.scale, posterior.columns, posterior.trees.arrays())
        with suppress(RuntimeError, OSError):  # a user without a home
            name = digest((RESULTS_VERSION, decisive, learned))
            return cls(_folder() / f"{name}.npz")
        return None

    def read(self) -> Known:
        """Log-odds of each case by cause and number; empty where nothing can be read."""
        try:
            return load_model(self.path, _KIND, _built)
        except ParameterError:
            return {}

    def write(self, known: Mapping[tuple[frozenset[str], int], NDArray[np.float64]]) -> None:
        """Keep cases; without effect where the folder cannot be written.

        Parameters
        ----------
        known : mapping of (frozenset of str, int) to ndarray, shape (n_causes,)
            Natural logarithms of odds of each case by cause and number [-].
        """
        header = {"cases": [[sorted(hypothesis), number] for hypothesis, number in known]}
        arrays = {f"odds{i}": odds for i, odds in enumerate(known.values())}
        with suppress(ParameterError, OSError):
            save_model(self.path, _KIND, header, arrays)
            kept = sorted(self.path.parent.glob("*.npz"), key=lambda path: path.stat().st_mtime)
            for old in kept[:-_MOST]:
                old.unlink(missing_ok=True)


def _built(header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> Known:
    return {
        (frozenset(causes), int(number)): np.asarray(arrays[f"odds{i}"], np.float64)
        for i, (causes, number) in enumerate(header["cases"])
    }


def _folder() -> Path:
    """Return the user's folder for what can be made again."""
    return user_cache_path("bushing-noise", appauthor=False) / "local-cases"
