"""Reader of logger files in a separate process with limits on time and memory.

On a damaged file the libraries may hang in a circle of pointers, allocate gigabytes or crash. In a
separate process with limits on time and memory this only refuses one recording. The process writes
the samples into a plain file, which is mapped into memory here. It is reused for further files,
because starting it takes a second.
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

_TIME_LIMIT = 15.0
"""Time for reading a small file [s]."""

_SLOWEST = 1e6
"""Lowest reading speed, which adds time for large files [byte/s]."""

_MEMORY_LIMIT = 2 << 30
"""Memory for reading a file, in addition to four times its size [byte]."""

_one_at_a_time = threading.Lock()


@contextmanager
def open_isolated(path: Path) -> Iterator[RawRecording]:
    """Open a logger file.

    Parameters
    ----------
    path : Path
        Existing file.

    Yields
    ------
    RawRecording
        Channels in the order of the file, in SI units.

    Raises
    ------
    RecordingError
        The file is damaged, holds no channels, its channels do not match, reading it exceeds the
        limits, or its library is not installed.
    """
    file_format = formats()[path.suffix.lower()]
    if find_spec(file_format.library) is None:
        message = not_installed(
            f"{path}: {file_format.name} files need", file_format.library, file_format.extra
        )
        raise RecordingError(message)
    path.open("rb").close()  # an unreadable file is not reported as damaged
    with TemporaryDirectory(prefix="bushing-noise-", ignore_cleanup_errors=True) as folder:
        target = Path(folder) / "samples"
        raw = _converted(path, target, file_format.name)
        samples = np.memmap(target, np.float64, "r", shape=(raw.n_channels, raw.n_samples))
        if os.name != "nt":
            target.unlink()  # the mapping keeps the content; a killed process leaves no file
        yield replace(raw, read=lambda first, last: np.array(samples[:, first:last]))


def _converted(path: Path, target: Path, name: str) -> RawRecording:
    """Convert a file in the reading process; return its metadata."""
    seconds = _TIME_LIMIT + path.stat().st_size / _SLOWEST
    folder = os.curdir if path.is_absolute() else Path.cwd()
    with _one_at_a_time:
        try:
            _worker(os.getpid()).submit(os.getpid).result()
        except BrokenExecutor:  # the process has ended since the last file
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
    """Return the reading process of a process, by its number: a fork needs its own."""
    return Worker()


# --- in the reading process ----------------------------------------------------------------------


def _convert(folder: str | Path, path: Path, target: Path, seconds: float) -> RawRecording:
    """Read a file under the memory limit and write its samples to `target`."""
    alarm = getattr(signal, "alarm", lambda _: None)
    alarm(int(seconds) + 10)  # ends this process if its parent is gone
    null_device = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null_device, 1)  # some libraries print warnings
    os.dup2(null_device, 2)
    os.close(null_device)
    os.chdir(folder)
    file_format = formats()[path.suffix.lower()]
    import_module(file_format.library)
    memory = _MEMORY_LIMIT + 4 * path.stat().st_size
    _limit_memory(memory)
    try:
        with file_format.channels(path) as channels:  # type: ignore[misc]
            return convert(path, channels, target)
    except RecordingError:
        raise
    except MemoryError:
        reason = f"reading it took more than {memory / 1e9:.1f} GB of memory"
    except Exception as error:
        reason = one_line(f"{type(error).__name__}: {error}")
    finally:
        alarm(0)
        _limit_memory(None)
    raise RecordingError(f"{path}: is damaged or no {file_format.name} file ({reason})")


def _limit_memory(more: int | None) -> None:
    """Limit the additional memory of this process [byte] on systems that support it."""
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
