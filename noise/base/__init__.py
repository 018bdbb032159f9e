"""Foundations of every part of the program: whole files, tables, models, trees, progress."""

from __future__ import annotations

import math
import tomllib
from importlib import resources
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np

SURE_90 = 1.645
"""So many standard deviations of a normal distribution to either side hold 90 % [-]."""


def log_uniform(low: float, high: float, rng: np.random.Generator) -> float:
    """Draw evenly in the logarithm.

    Parameters
    ----------
    low, high : float
        Limits, above 0 [any one unit].
    rng : numpy.random.Generator

    Returns
    -------
    float
        [unit of the limits]

    Examples
    --------
    >>> import numpy as np
    >>> 1.0 <= log_uniform(1.0, 100.0, np.random.default_rng(0)) <= 100.0
    True
    """
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def packaged_toml(package: str, name: str) -> dict[str, Any]:
    """Read a TOML file that comes with a package.

    Parameters
    ----------
    package : str
        Its full name.
    name : str
        Of the file.

    Examples
    --------
    >>> packaged_toml("noise.screening", "environments.toml")["dry"]["temperature_C"]
    23.0
    """
    return tomllib.loads((resources.files(package) / name).read_text(encoding="utf-8"))
