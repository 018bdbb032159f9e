"""Loggers' files read in a process of its own, with limits on time and memory.

Libraries that follow the pointers of a file hang on one that leads in a circle, set aside the 4 GB
that a damaged length asks for, or die. They do so in a process that is ended when it takes too
long and may not have more memory than a file of that size can need; whatever becomes of it, here it
is one recording refused. It writes the samples into a plain file of numbers, of which any part can
be had. The process lives on from file to file, since it costs a second to start.
"""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, TimeoutError as TookLongerError
from contextlib import contextmanager
from dataclasses import replace
from functools import lru_cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from models.errors import RecordingError, not_installed
from models.foreign_file import one_line
from noise.base.processes import Worker
from noise.recordings.formats import RawRecording, formats
from noise.recordings.formats.logged import convert

_PATIENCE = 15.0
"""How long reading may take, beside the size of the file [s]."""

_SLOWEST = 1e6
"""What is read at least, of a large file over a network [byte/s]."""

_ALLOWANCE = 2 << 30
"""Memory that a file may take, beside four times its size [byte]."""

_one_at_a_time = threading.Lock()


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
        The file is damaged, holds no channels, these do not go together, or reading took longer or
        more memory than it may; or its library is not installed.
    """
    of = formats()[path.suffix.lower()]
    if find_spec(of.library) is None:
        message = not_installed(f"{path}: {of.name} files need", of.library, of.extra)
        raise RecordingError(message)
    path.open("rb").close()  # a file that may not be read is not damaged
    with TemporaryDirectory(prefix="bushing-noise-", ignore_cleanup_errors=True) as folder:
        target = Path(folder) / "samples"
        raw = _converted(path, target, of.name)
        samples = np.memmap(target, np.float64, "r", shape=(raw.n_channels, raw.n_samples))
        if os.name != "nt":
            target.unlink()  # mapped, it stays until then, whatever becomes of this process
        yield replace(raw, read=lambda first, last: np.array(samples[:, first:last]))


def _converted(path: Path, target: Path, name: str) -> RawRecording:
    """Have the samples of a file written; return what it states of them."""
    seconds = _PATIENCE + path.stat().st_size / _SLOWEST
    folder = os.curdir if path.is_absolute() else Path.cwd()
    with _one_at_a_time:
        try:
            _worker(os.getpid()).submit(os.getpid).result()
        except BrokenExecutor:  # it ended meanwhile
            _worker.cache_clear()
        worker = _worker(os.getpid())
        try:
            return worker.submit(_convert, folder, path, target, seconds).result(seconds)
        except TookLongerError:
            reason = f"took longer than {seconds:.0f} s"
        except (BrokenExecutor, OSError):
            reason = "ended the process"
        worker.end()
        _worker.cache_clear()
    raise RecordingError(f"{path}: is damaged or no {name} file (reading it {reason})")


@lru_cache(maxsize=1)
def _worker(_owner: int) -> Worker:
    """Return the process that reads for this one; a fork needs one of its own."""
    return Worker()


# --- in the process that reads -------------------------------------------------------------------


def _convert(folder: str | Path, path: Path, target: Path, seconds: float) -> RawRecording:
    alarm = getattr(signal, "alarm", lambda _: None)
    alarm(int(seconds) + 10)  # should nobody be there any more to end it
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)  # some libraries print what they cannot follow
    os.dup2(nowhere, 2)
    os.close(nowhere)
    os.chdir(folder)
    of = formats()[path.suffix.lower()]
    import_module(of.library)
    memory = _ALLOWANCE + 4 * path.stat().st_size
    _limit_memory(memory)
    try:
        with of.channels(path) as (channels, properties):  # type: ignore[misc]
            return convert(path, channels, properties, target)
    except RecordingError:
        raise
    except MemoryError:
        reason = f"reading it took more than {memory / 1e9:.1f} GB of memory"
    except Exception as error:
        reason = one_line(f"{type(error).__name__}: {error}")
    finally:
        alarm(0)
        _limit_memory(None)
    raise RecordingError(f"{path}: is damaged or no {of.name} file ({reason})")


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
