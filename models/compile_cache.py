"""A folder for compiled code on machines where numba finds none by itself.

numba keeps what it compiled beside the source, or in the user's cache folder, and gives up where
neither can be written: an installation that only its owner may change, and a user without a home,
as containers and services have them. There a folder of the user's own among the temporary files
takes its place. It holds machine code, which is run as it is found, so a folder that anybody else
could have prepared is not used: nothing is kept then, and every start compiles again.

It is set up when the first of our packages is imported, since compiled functions ask for their
folder where they are defined. A folder that the user names (``NUMBA_CACHE_DIR``) comes first.
matplotlib, which keeps a list of fonts, is in the same plight, and is given the same folder.
"""

from __future__ import annotations

import os
import stat
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["ensure_compile_cache"]

_VARIABLE = "NUMBA_CACHE_DIR"
_MATPLOTLIB = "MPLCONFIGDIR"
_PACKAGES = ("models", "sim", "features", "noise")


def ensure_compile_cache() -> None:
    """Name numba a folder where it would find none; without any, let it compile each time anew.

    Examples
    --------
    >>> ensure_compile_cache()
    """
    if _writable(_users_folder()):
        return
    named, own = os.environ.get(_VARIABLE, ""), _own_folder()
    # The processes that we start inherit the variable, and look for themselves who owns the folder.
    if named and Path(named) != own and _writable(Path(named)):
        return
    if all(map(_writable, _folders_beside_sources())):
        return
    if own is None or not _is_ours(own):
        os.environ.pop(_VARIABLE, None)
        _keep_nothing()
        return
    os.environ[_VARIABLE] = str(own)
    os.environ.setdefault(_MATPLOTLIB, str(own))  # it would make one anew each time, and say so
    if "numba" in sys.modules:  # it has read the variable
        sys.modules["numba"].config.CACHE_DIR = str(own)


def _writable(folder: Path) -> bool:
    """Whether files can be made in a folder, or the folder itself where it is not there yet."""
    above = next((place for place in (folder, *folder.parents) if os.path.lexists(place)), folder)
    return above.is_dir() and os.access(above, os.W_OK | os.X_OK)


def _users_folder() -> Path:
    """Return the folder that numba falls back to by itself."""
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", "~")).expanduser() / "numba"
    if sys.platform == "darwin":
        return Path(os.path.expanduser("~/Library/Caches/numba"))  # noqa: PTH111  # never raises
    return Path(os.environ.get("XDG_CACHE_HOME", os.path.expanduser("~/.cache"))) / "numba"  # noqa: PTH111


def _folders_beside_sources() -> Iterator[Path]:
    """Go through the caches beside our sources, and beside those of librosa, which compiles too."""
    from importlib.util import find_spec

    roots = [Path(__file__).parent.parent / package for package in _PACKAGES]
    librosa = find_spec("librosa")
    if librosa is not None and librosa.origin is not None:
        roots.append(Path(librosa.origin).parent)
    for root in roots:
        for folder, inner, _ in os.walk(root):
            inner[:] = [name for name in inner if name != "__pycache__"]
            yield Path(folder) / "__pycache__"


def _own_folder() -> Path | None:
    """Return where the user's folder among the temporary files would be."""
    import tempfile

    try:
        temporary = tempfile.gettempdir()
    except OSError:  # there is nowhere to write
        return None
    user = f"-{os.getuid()}" if hasattr(os, "getuid") else ""  # elsewhere each user has their own
    return Path(temporary) / f"bushing-noise{user}"


def _is_ours(folder: Path) -> bool:
    """Make the folder; return whether nobody else can have put anything there."""
    try:
        if not os.path.lexists(folder):
            folder.mkdir(mode=0o700)
        found, above = folder.lstat(), folder.parent.stat()
    except OSError:
        return False
    if not stat.S_ISDIR(found.st_mode):
        return False
    if not hasattr(os, "getuid"):
        return True
    # In a folder of many, only the sticky bit keeps others from putting theirs in place of ours.
    kept = not above.st_mode & (stat.S_IWGRP | stat.S_IWOTH) or bool(above.st_mode & stat.S_ISVTX)
    return kept and found.st_uid == os.getuid() and stat.S_IMODE(found.st_mode) == 0o700


def _keep_nothing() -> None:
    """Let compiled functions do without a folder; say so once."""
    from numba.core.dispatcher import Dispatcher
    from numba.np.ufunc.ufuncbuilder import UFuncDispatcher

    def enable_caching(_: object) -> None:
        """Keep nothing."""

    for kind in (Dispatcher, UFuncDispatcher):
        setattr(kind, "enable_caching", enable_caching)  # noqa: B010  # numba has no types
    from multiprocessing import parent_process

    if parent_process() is None and sys.stderr is not None:
        sys.stderr.write(
            "bushing-noise: note: there is no safe folder for compiled code, so every start "
            f"compiles again; {_VARIABLE} names one\n"
        )
