"""Loggers' files read in a process of its own, with limits on time and memory.

Libraries that follow the pointers of a file hang on one that leads in a circle, set aside the 4 GB
that a damaged length asks for, or die. They do so in a process that is ended when it takes too
long and may not have more memory than a file of that size can need; whatever becomes of it, here it
is one recording refused. A process lives on from file to file, since it costs a second to start.
Samples come over part by part, so that reading takes the memory of the result and no more.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, TimeoutError as TookLongerError
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.errors import RecordingError, not_installed
from models.foreign_file import one_line
from noise.base.processes import Worker
from noise.recordings.formats import RawRecording, formats
from noise.recordings.formats.logged import describe_channels

_PATIENCE = 15.0
"""How long an answer may take, beside the size of the file [s]."""

_SLOWEST = 1e6
"""What is read at least, of a large file over a network [byte/s]."""

_ALLOWANCE = 2 << 30
"""Memory that a file may take, beside four times its size [byte]."""

_idle: list[tuple[int, Worker]] = []
"""A process that waits for its next file, and whose it is: a fork needs one of its own."""


@contextmanager
def open_isolated(path: Path) -> Iterator[RawRecording]:
    """Open a logger's file.

    Parameters
    ----------
    path : Path
        An existing file.

    Yields
    ------
    RawRecording
        Its channels in the order of the file, in SI.

    Raises
    ------
    RecordingError
        Also by reading it: the file is damaged, holds no channels, these do not go together, or
        reading took longer or more memory than it may; or its library is not installed.
    """
    of = formats()[path.suffix.lower()]
    if find_spec(of.library) is None:
        message = not_installed(f"{path}: {of.name} files need", of.library, of.extra)
        raise RecordingError(message)
    path.open("rb").close()  # a file that may not be read is not damaged
    size = path.stat().st_size
    seconds = _PATIENCE + size / _SLOWEST
    worker, at_rest = _borrowed(), False

    def ask(perform: Callable[..., Any], *given: object) -> Any:
        nonlocal at_rest
        at_rest = False
        try:
            answer = worker.submit(_timed, seconds, perform, *given).result(seconds)
        except RecordingError:
            at_rest = True
            raise
        except TookLongerError:
            reason = f"took longer than {seconds:.0f} s"
        except (BrokenExecutor, OSError):
            reason = "ended the process"
        else:
            at_rest = True
            return answer
        raise RecordingError(f"{path}: is damaged or no {of.name} file (reading it {reason})")

    try:
        raw = ask(_open, os.curdir if path.is_absolute() else Path.cwd(), path, size)
        yield replace(raw, read=lambda first, last: ask(raw.read, first, last))
    finally:
        if at_rest:
            with suppress(RecordingError):  # it died of the last part
                ask(_close)
        if at_rest and not _idle:
            _idle.append((os.getpid(), worker))
        else:
            worker.end()


def _borrowed() -> Worker:
    with suppress(IndexError, BrokenExecutor):
        owner, worker = _idle.pop()
        if owner == os.getpid() and worker.submit(os.getpid).result():
            return worker
    return Worker()


# --- in the process that reads -------------------------------------------------------------------


class _Opened(NamedTuple):
    """The file that is open, how to refuse it, and what closes it."""

    file: ExitStack
    raw: RawRecording
    refusal: str
    memory: int


_opened: list[_Opened] = []


def _timed(seconds: float, perform: Callable[..., Any], *given: object) -> Any:
    """Do a call in a process that ends should nobody be there any more to end it."""
    alarm = getattr(signal, "alarm", lambda _: None)
    alarm(int(seconds) + 10)
    try:
        return perform(*given)
    finally:
        alarm(0)


def _open(folder: str | Path, path: Path, size: int) -> RawRecording:
    _close()
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)  # some libraries print what they cannot follow
    os.dup2(nowhere, 2)
    os.close(nowhere)
    os.chdir(folder)
    of = formats()[path.suffix.lower()]
    import_module(of.library)
    memory = _ALLOWANCE + 4 * size
    _limit_memory(memory)
    refusal = f"{path}: is damaged or no {of.name} file"
    with ExitStack() as stack, _refusing(refusal, memory):
        channels, properties = stack.enter_context(of.channels(path))  # type: ignore[misc]
        raw = describe_channels(path, channels, properties)
        _opened.append(_Opened(stack.pop_all(), raw, refusal, memory))
    return replace(raw, read=_read)


def _read(first: int, last: int) -> NDArray[np.float64]:
    (opened,) = _opened
    with _refusing(opened.refusal, opened.memory):
        return opened.raw.read(first, last)


def _close() -> None:
    while _opened:
        with suppress(Exception):  # of a damaged file
            _opened.pop().file.close()
    _limit_memory(None)


@contextmanager
def _refusing(refusal: str, memory: int) -> Iterator[None]:
    try:
        yield
    except RecordingError:
        raise
    except MemoryError:
        reason = f"reading it took more than {memory / 1e9:.1f} GB of memory"
        raise RecordingError(f"{refusal} ({reason})") from None
    except Exception as error:
        reason = one_line(f"{type(error).__name__}: {error}")
        raise RecordingError(f"{refusal} ({reason})") from None


def _limit_memory(more: int | None) -> None:
    """Allow this process so many bytes more than it has, where the system counts them."""
    try:
        import resource

        pages = int(Path("/proc/self/statm").read_text().split()[0])
    except (ImportError, OSError):
        return
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    least = hard if more is None else pages * resource.getpagesize() + more
    if hard != resource.RLIM_INFINITY and more is not None:
        least = min(least, hard)
    resource.setrlimit(resource.RLIMIT_AS, (least, hard))
