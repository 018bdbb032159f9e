"""Linear algebra on one thread.

The matrices here have some hundred rows. Several threads gain little on them, and where the
machine is busy they wait for each other, ten times longer than one takes.
"""

from __future__ import annotations

from contextlib import AbstractContextManager
from functools import lru_cache

import numpy as np
import scipy.linalg
from threadpoolctl import ThreadpoolController

_LOADED = (np, scipy.linalg)
"""Each brings a library of its own, which the controller must find."""


def single_thread() -> AbstractContextManager[object]:
    """Context in which numpy and scipy use one thread for linear algebra.

    Examples
    --------
    >>> with single_thread():
    ...     np.eye(2) @ np.ones(2)
    array([1., 1.])
    """
    limit: AbstractContextManager[object] = _controller().limit(limits=1, user_api="blas")
    return limit


@lru_cache(maxsize=1)
def _controller() -> ThreadpoolController:
    return ThreadpoolController()
