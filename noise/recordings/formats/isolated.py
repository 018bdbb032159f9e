"""Loggers' files read in a process of its own, with limits on time and memory.

Libraries that follow the pointers of a file hang on one that leads in a circle, set aside the 4 GB
that a damaged length asks for, or die. They do so in a process that is killed when it takes too
long and may not have more memory than a file of that size can need; whatever becomes of it, here it
is one recording refused. The process lives on from file to file, since it costs a second to start,
and ends with the one that asks it. Samples come over in blocks, so that reading takes the memory of
the result and no more; or, of a long file, part by part as they are asked for, from a process that
has the file open and is its own.
"""

from __future__ import annotations

import atexit
import os
import pickle
import signal
import subprocess
import sys
import threading
from contextlib import contextmanager, suppress
from dataclasses import replace
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from models.errors import RecordingError, not_installed

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from noise.recordings.files import RawSamples

__all__ = ["open_isolated", "read_isolated", "serve"]

_PATIENCE = 15.0
"""How long a file may take, beside its size [s]."""

_SLOWEST = 1e6
"""What is read at least, of a large file over a network [byte/s]."""

_ALLOWANCE = 2 << 30
"""Memory that a file may take, beside four times its size [byte]."""

_LONGEST_REASON = 200  # letters


class _Format(NamedTuple):
    """How files are called, who reads them, the library for it and the extra that installs it."""

    name: str
    reader: str
    library: str
    extra: str


_HDF5 = _Format("HDF5", "noise.recordings.formats.hdf5_file:open_hdf5", "h5py", "hdf5")
_MDF = _Format("MDF", "noise.recordings.formats.mdf_file:open_mdf", "asammdf", "mdf")
_TDMS = _Format("TDMS", "noise.recordings.formats.tdms_file:open_tdms", "nptdms", "tdms")
_FORMATS = {".h5": _HDF5, ".hdf5": _HDF5, ".mdf": _MDF, ".mf4": _MDF, ".tdms": _TDMS}

_processes: dict[int, Any] = {}  # by the process that asks: a fork needs one of its own
_lock = threading.Lock()


def read_isolated(path: Path) -> RawSamples:
    """Read the channels of a logger's file.

    Parameters
    ----------
    path : Path
        An existing file.

    Returns
    -------
    RawSamples
        Samples in SI, in the order of the file.

    Raises
    ------
    RecordingError
        The file is damaged, holds no channels, these do not go together, or reading it took longer
        or more memory than it may; or its library is not installed.
    """
    of, size = _format(path)
    with _lock, _process(path, of, _PATIENCE + size / _SLOWEST) as process:
        raw, n_samples = _asked(process, path, of, size, in_parts=False)
        samples = np.empty((len(raw.samples), n_samples))
        for row in samples:
            position = 0
            while position < n_samples:
                block = _answer(process)
                row[position : position + block.size] = block
                position += block.size
        return replace(raw, samples=samples)


@contextmanager
def open_isolated(
    path: Path,
) -> Iterator[tuple[RawSamples, int, Callable[[int, int], NDArray[np.float64]]]]:
    """Open a logger's file; give what `read_isolated` does without samples, and what reads them.

    They are read from first and last sample, shape (n_channels, n), in SI. Both raise as
    `read_isolated` does.
    """
    of, size = _format(path)
    process = _started()
    seconds = _PATIENCE + size / _SLOWEST

    def read(first: int, last: int) -> NDArray[np.float64]:
        with _watched(process, path, of, seconds):
            _ask(process, (first, last))
            return np.asarray(_answer(process)).reshape(n_rows, last - first)

    try:
        with _watched(process, path, of, seconds):
            raw, n_samples = _asked(process, path, of, size, in_parts=True)
        n_rows = len(raw.samples)
        yield raw, n_samples, read
    finally:
        _end(process)


def _format(path: Path) -> tuple[_Format, int]:
    """Return what reads a file, and its size [byte]."""
    of = _FORMATS[path.suffix.lower()]
    if find_spec(of.library) is None:
        message = not_installed(f"{path}: {of.name} files need", of.library, of.extra)
        raise RecordingError(message)
    path.open("rb").close()  # a file that may not be read is not damaged
    return of, path.stat().st_size


def _asked(
    process: Any, path: Path, of: _Format, size: int, *, in_parts: bool
) -> tuple[RawSamples, int]:
    folder = os.curdir if path.is_absolute() else str(Path.cwd())
    _ask(process, (folder, path, of, size, in_parts))
    answer: tuple[RawSamples, int] = _answer(process)
    return answer


def _ask(process: Any, question: object) -> None:
    pickle.dump(question, process.stdin)
    process.stdin.flush()


@contextmanager
def _process(path: Path, of: _Format, seconds: float) -> Iterator[Any]:
    """Give the process that reads, for so long; one that did not answer is replaced."""
    process = _processes.get(os.getpid())
    if process is None or process.poll() is not None:
        process = _processes[os.getpid()] = _started()
    with _watched(process, path, of, seconds):
        yield process


@contextmanager
def _watched(process: Any, path: Path, of: _Format, seconds: float) -> Iterator[None]:
    """End a process that does not answer for so long, and say why there is no answer."""
    late = threading.Event()

    def end() -> None:
        late.set()
        process.kill()

    timer = threading.Timer(seconds, end)
    timer.start()
    try:
        yield
    except RecordingError:
        raise
    except (EOFError, OSError, pickle.UnpicklingError) as error:
        _end(process)
        reason = f"took longer than {seconds:.0f} s" if late.is_set() else "ended the process"
        raise RecordingError(
            f"{path}: is damaged or no {of.name} file (reading it {reason})"
        ) from error
    except BaseException:  # an interrupt, after which answers would be to another question
        _end(process)
        raise
    finally:
        timer.cancel()


def _started() -> Any:
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
    if (process := _processes.pop(os.getpid(), None)) is not None:
        _end(process)


def _answer(process: Any) -> Any:
    answer = pickle.load(process.stdout)
    if isinstance(answer, str):
        raise RecordingError(answer)
    return answer


def serve() -> None:
    """Read what is asked for on standard input, until there is nobody left to ask."""
    answers = os.fdopen(os.dup(1), "wb")
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)  # some libraries print what they cannot follow
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # meant for the process that asks
    while True:
        try:
            folder, path, of, size, in_parts = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        os.chdir(folder)
        if hasattr(signal, "alarm") and not in_parts:  # should nobody be there any more to kill it
            signal.alarm(int(_PATIENCE + size / _SLOWEST) + 10)
        for answer in _answers(path, of, _ALLOWANCE + 4 * size, in_parts=in_parts):
            pickle.dump(answer, answers, protocol=5)
            answers.flush()
        if hasattr(signal, "alarm"):
            signal.alarm(0)


def _answers(path: Path, of: _Format, memory: int, *, in_parts: bool) -> Iterator[Any]:
    """Give what the channels are and how long, then their samples; or a text why not."""
    from noise.recordings.formats.logged import describe_channels, sample_blocks

    try:
        _limit_memory(None)
        module, _, function = of.reader.partition(":")
        reader = getattr(import_module(module), function)
        import_module(of.library)
        _limit_memory(memory)
        with reader(path) as (channels, properties):
            raw, rows = describe_channels(path, channels, properties)
            yield raw, rows[0][0].n_samples
            if not in_parts:
                yield from sample_blocks(path, rows)
                return
            while True:  # until there is nobody left to ask
                yield np.concatenate(
                    list(sample_blocks(path, rows, *pickle.load(sys.stdin.buffer)))
                )
    except EOFError:
        return
    except RecordingError as error:
        yield str(error)
    except MemoryError:
        yield (
            f"{path}: is damaged or no {of.name} file (reading it took more than "
            f"{memory / 1e9:.1f} GB of memory)"
        )
    except Exception as error:
        reason = " ".join(f"{type(error).__name__}: {error}".split())[:_LONGEST_REASON]
        yield f"{path}: is damaged or no {of.name} file ({reason})"


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
