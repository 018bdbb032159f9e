"""Processes that joblib starts, and that end with the one that started them.

joblib's processes wait for more work for minutes after whoever they work for was killed, and finish
first what they were given.
"""

from __future__ import annotations

import os
import threading
import time
from functools import lru_cache, partial
from typing import TYPE_CHECKING, ParamSpec, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["ending_with_this"]

Given = ParamSpec("Given")
Result = TypeVar("Result")

_EVERY = 0.5
"""Between looks at who a process works for [s]."""


def ending_with_this(work: Callable[Given, Result]) -> Callable[Given, Result]:
    """Return work whose process ends when this one does, however that is.

    Parameters
    ----------
    work : callable
        That can be sent to another process.

    Returns
    -------
    callable
        Does the same, and in this process no more than that.

    Examples
    --------
    >>> ending_with_this(max)(1, 2)
    2
    """
    return partial(_watched, os.getpid(), work)


def _watched(
    starter: int, work: Callable[Given, Result], *given: Given.args, **named: Given.kwargs
) -> Result:
    if os.getppid() == starter and os.name != "nt":  # there nobody else becomes the parent
        _watch(starter)
    return work(*given, **named)


@lru_cache(maxsize=1)
def _watch(starter: int) -> None:
    def watch() -> None:
        while os.getppid() == starter:
            time.sleep(_EVERY)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
