"""Loggers' files read in a process of its own, with limits on time and memory.

Libraries that follow the pointers of a file hang on one that leads in a circle, set aside the 4 GB
that a damaged length asks for, or die. They do so in a process that is killed when it takes too
long and may not have more memory than a file of that size can need; whatever becomes of it, here it
is one recording refused. A process lives on from file to file, since it costs a second to start,
and ends with the one that asks it. Samples come over part by part, so that reading takes the memory
of the result and no more.

A pool of `multiprocessing` would import the caller's script again, and could not be used by the
processes of a batch.
"""

from __future__ import annotations

import atexit
import os
import pickle
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.errors import RecordingError, not_installed
from noise.recordings.formats import RawRecording, formats

_PATIENCE = 15.0
"""How long an answer may take, beside the size of the file [s]."""

_SLOWEST = 1e6
"""What is read at least, of a large file over a network [byte/s]."""

_ALLOWANCE = 2 << 30
"""Memory that a file may take, beside four times its size [byte]."""

_LONGEST_REASON = 200  # letters

_idle: list[tuple[int, Any]] = []
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
    process = _borrowed()

    seconds = _PATIENCE + size / _SLOWEST
    idle = False

    def ask(question: object) -> Any:
        nonlocal idle
        idle = False
        late = threading.Timer(seconds, process.kill)
        late.start()
        try:
            pickle.dump(question, process.stdin)
            process.stdin.flush()
            answer = pickle.load(process.stdout)
        except (EOFError, OSError, pickle.UnpicklingError) as error:
            took = f"took longer than {seconds:.0f} s"
            reason = took if late.finished.is_set() else "ended the process"
            raise RecordingError(
                f"{path}: is damaged or no {of.name} file (reading it {reason})"
            ) from error
        finally:
            late.cancel()
        if isinstance(answer, str):  # after which it waits for another file
            idle = True
            raise RecordingError(answer)
        return answer

    try:
        folder = os.curdir if path.is_absolute() else str(Path.cwd())
        raw = ask((folder, path, _ALLOWANCE + 4 * size, seconds))
        yield replace(raw, read=lambda first, last: ask((first, last)))
        with suppress(RecordingError):  # it died of the last part
            idle = ask(None)
    finally:
        if idle and not _idle:
            _idle.append((os.getpid(), process))
        else:
            _end(process)


def _borrowed() -> Any:
    with suppress(IndexError):
        owner, process = _idle.pop()
        if owner == os.getpid() and process.poll() is None:
            return process
    call = f"import sys; sys.path[:] = {sys.path!r}; from {__name__} import serve; serve()"
    return subprocess.Popen(
        [sys.executable, "-c", call],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )


def _end(process: Any) -> None:
    process.kill()
    process.wait()
    for pipe in (process.stdin, process.stdout):
        with suppress(OSError):  # what it did not take is lost with it
            pipe.close()


@atexit.register
def _end_with_us() -> None:
    while _idle:
        owner, process = _idle.pop()
        if owner == os.getpid():
            _end(process)


# --- in the process that reads -------------------------------------------------------------------


def serve() -> None:
    """Read what is asked for on standard input, until there is nobody left to ask."""
    answers = os.fdopen(os.dup(1), "wb")
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)  # some libraries print what they cannot follow
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # meant for the process that asks

    def receive() -> Any:
        _alarm(0.0)
        question = pickle.load(sys.stdin.buffer)
        _alarm(seconds)  # should nobody be there any more to kill it
        return question

    def send(value: object) -> None:
        pickle.dump(value, answers, protocol=5)
        answers.flush()

    seconds = 0.0
    with suppress(EOFError):
        while True:
            folder, path, memory, patience = receive()
            seconds = patience + 10.0
            _alarm(seconds)
            os.chdir(folder)
            send(_serve_file(path, memory, send, receive) or True)


def _alarm(seconds: float) -> None:
    if hasattr(signal, "alarm"):
        signal.alarm(int(seconds))


def _serve_file(
    path: Path, memory: int, send: Callable[[object], None], receive: Callable[[], Any]
) -> str:
    """Send the channels of a file, then parts of them as asked for; return why it is refused."""
    from noise.recordings.formats.logged import describe_channels

    of = formats()[path.suffix.lower()]
    _limit_memory(None)
    try:
        import_module(of.library)
        _limit_memory(memory)
        with of.channels(path) as (channels, properties):  # type: ignore[misc]
            raw = describe_channels(path, channels, properties)
            send(replace(raw, read=_elsewhere))
            while (part := receive()) is not None:
                send(raw.read(*part))
    except RecordingError as error:
        return str(error)
    except MemoryError:
        return (
            f"{path}: is damaged or no {of.name} file (reading it took more than "
            f"{memory / 1e9:.1f} GB of memory)"
        )
    except Exception as error:
        reason = " ".join(f"{type(error).__name__}: {error}".split())[:_LONGEST_REASON]
        return f"{path}: is damaged or no {of.name} file ({reason})"
    return ""


def _elsewhere(first: int, last: int) -> NDArray[np.float64]:
    """Stand in for what reads samples, which stays with the file."""
    raise NotImplementedError


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
