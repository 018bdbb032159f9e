"""Options of compiled functions, and the fallback folder of numba's cache.

Compilation dominates the first run. numba caches compiled code beside the source or in the user's
cache folder. Users without a home, as in containers and services, get a private temporary folder
for the life of the process: it contains machine code, so a folder that others could write to is not
used.
"""

import atexit
import os
import shutil
import tempfile
from pathlib import Path
from typing import Any

import platformdirs

COMPILED: dict[str, Any] = {"error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True}
"""Options of functions that only read and write arrays of their caller.

They leave out reference counting of arrays and the wrapper for calls from C.
"""

PART: dict[str, Any] = {**COMPILED, "no_cpython_wrapper": True}
"""Options of such functions that only compiled functions call, cached with their caller."""


def ensure_compile_cache() -> None:
    """Set a cache folder for numba if it has none, before the first compilation.

    A folder that the user sets (``NUMBA_CACHE_DIR``) takes precedence. matplotlib's cache of fonts
    gets the same folder.

    Examples
    --------
    >>> ensure_compile_cache()
    """
    users = Path(platformdirs.user_cache_dir("numba"))
    above = next(place for place in (users, *users.parents) if os.path.lexists(place))
    writable = above.is_dir() and os.access(above, os.W_OK | os.X_OK)
    if "NUMBA_CACHE_DIR" in os.environ or writable:
        return
    private = tempfile.mkdtemp(prefix="bushing-noise-")
    atexit.register(shutil.rmtree, private, ignore_errors=True)
    os.environ["NUMBA_CACHE_DIR"] = private  # inherited by child processes
    os.environ.setdefault("MPLCONFIGDIR", private)
