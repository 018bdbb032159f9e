# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
# ruff: noqa: ANN001
"""Compiled functions in place of a friction law or effects that there are not."""

from __future__ import annotations

from numba import njit

from sim.contact import HOOK_SIGNATURE, LAW_SIGNATURE

__all__ = ["no_hook", "no_law"]


@njit(HOOK_SIGNATURE, cache=True)
def no_hook(context, values, state, state_rates, contact) -> None:
    """Leave the contact as it is."""


@njit(LAW_SIGNATURE, cache=True)
def no_law(sliding_speed, coefficients, contact, state, state_rates) -> float:  # noqa: ARG001
    """Stand in for a law where the contact truly sticks: no torque [Nm]."""
    return 0.0
