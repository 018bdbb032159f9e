"""Compiled hooks and laws called from Python, at one instant."""

import ctypes
from functools import lru_cache
from typing import Any

from sim.contact import address_of


def call_hook(
    hook: Any, context: Any, values: Any, state: Any, state_rates: Any, contact: Any
) -> None:
    """Call an effect's compiled function with arrays, by `HOOK_SIGNATURE`."""
    arrays = context, values, state, state_rates, contact
    _c_function(hook, None)(*(array.ctypes.data for array in arrays))


def call_law(
    law: Any, sliding_speed: float, coefficients: Any, contact: Any, state: Any, state_rates: Any
) -> float:
    """Call a law's compiled function with arrays, by `LAW_SIGNATURE`; returns its torque [Nm]."""
    arrays = coefficients, contact, state, state_rates
    function = _c_function(law, ctypes.c_double, ctypes.c_double)
    return float(function(sliding_speed, *(array.ctypes.data for array in arrays)))


@lru_cache(maxsize=64)
def _c_function(compiled: Any, *kinds: Any) -> Any:
    kinds = *kinds, *[ctypes.c_void_p] * (6 - len(kinds))  # what it returns, then five arguments
    return ctypes.CFUNCTYPE(*kinds)(address_of(compiled))
