"""Options of the solvers' compiled functions.

Compiling is most of the first run's time. Parts that only compiled functions call are spared what
calling them from Python would need, and their own files in the cache: they lie in their callers'.
"""

from __future__ import annotations

from typing import Any

__all__ = ["PART", "UNCOUNTED"]

UNCOUNTED: dict[str, Any] = {"error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True}
"""Of functions that only read and write arrays of their caller's.

Without the counting of references to arrays, which would take longer than a step.
"""

PART: dict[str, Any] = {**UNCOUNTED, "no_cpython_wrapper": True}
"""Of such functions that only compiled functions call."""
