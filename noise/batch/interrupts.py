"""Processes that an interrupt is not meant for.

Ctrl-C in a terminal goes to all processes that were started there. One that works for another is
ended by that one. While it is loaded it cannot ignore interrupts yet, and would answer with an
error of its own; so it is started with interrupts blocked.
"""

from __future__ import annotations

import signal
from contextlib import contextmanager
from multiprocessing import resource_tracker
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["interrupts_blocked"]


@contextmanager
def interrupts_blocked() -> Iterator[None]:
    """Start processes within that never see an interrupt; this one sees it afterwards.

    Examples
    --------
    >>> with interrupts_blocked():
    ...     pass
    """
    if not hasattr(signal, "pthread_sigmask"):  # as on Windows
        yield
        return
    resource_tracker.ensure_running()  # started by the first process, it would let interrupts in
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
