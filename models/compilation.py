"""Options of compiled functions: compiling them is most of what a first run waits for."""

from __future__ import annotations

from typing import Any

__all__ = ["COMPILED", "PART"]

COMPILED: dict[str, Any] = {"error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True}
"""Of functions that only read and write arrays of their caller's.

Without the counting of references to arrays, and without what calling them from C would need.
"""

PART: dict[str, Any] = {**COMPILED, "no_cpython_wrapper": True}
"""Of such functions that only compiled functions call, in whose place in the cache they lie."""
