"""Shared foundations: file output, tables, model files, decision trees, processes, progress."""

from __future__ import annotations

import math
import tomllib
from importlib import resources
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np

SURE_90 = 1.645
"""Half-width of the central 90 % interval of a normal distribution, in standard deviations [-]."""


def log_uniform(low: float, high: float, rng: np.random.Generator) -> float:
    """Draw a number from a log-uniform distribution.

    Parameters
    ----------
    low, high : float
        Bounds, above 0 [any unit].
    rng : numpy.random.Generator

    Returns
    -------
    float
        [unit of the bounds]

    Examples
    --------
    >>> import numpy as np
    >>> 1.0 <= log_uniform(1.0, 100.0, np.random.default_rng(0)) <= 100.0
    True
    """
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def packaged_toml(package: str, name: str) -> dict[str, Any]:
    """Read a TOML file inside a package.

    Parameters
    ----------
    package : str
        Full name of the package.
    name : str
        Name of the file.

    Examples
    --------
    >>> packaged_toml("noise.screening", "environments.toml")["dry"]["temperature_C"]
    23.0
    """
    return tomllib.loads((resources.files(package) / name).read_text(encoding="utf-8"))
