"""Compiled functions: their options, and the folder that keeps them where numba finds none.

Compiling is most of what a first run waits for. numba keeps what it compiled beside the source, or
in the user's cache folder. A user without a home, as containers and services have them, gets a
folder among the temporary files that lasts as long as the process: it holds machine code, which is
run as it is found, so one that anybody else could have prepared is not used.
"""

import atexit
import os
import shutil
import tempfile
from pathlib import Path
from typing import Any

import platformdirs

COMPILED: dict[str, Any] = {"error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True}
"""Of functions that only read and write arrays of their caller's.

Without the counting of references to arrays, and without what calling them from C would need.
"""

PART: dict[str, Any] = {**COMPILED, "no_cpython_wrapper": True}
"""Of such functions that only compiled functions call, in whose place in the cache they lie."""


def ensure_compile_cache() -> None:
    """Name numba a folder where it would find none, before the first function asks for it.

    A folder that the user names (``NUMBA_CACHE_DIR``) comes first. matplotlib, which keeps a list
    of fonts, is in the same plight, and is given the same folder.

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
    os.environ["NUMBA_CACHE_DIR"] = private  # which the processes that we start inherit
    os.environ.setdefault("MPLCONFIGDIR", private)
