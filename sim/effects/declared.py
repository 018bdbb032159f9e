"""Whether an effect of a user's own file is declared in the types that `Effect` has."""

from __future__ import annotations

from collections.abc import Mapping
from numbers import Real
from typing import TYPE_CHECKING

from sim.effects.effect import Stage
from sim.parameters import Parameter

if TYPE_CHECKING:
    from sim.effects.effect import Effect

_FUNCTIONS = (
    "drive", "contact", "pack", "force", "chain", "sensors",
)  # fmt: skip


def what_is_wrong(effect: Effect) -> str:
    """Say which field of an effect holds something else than it should, "" where none does.

    Examples
    --------
    >>> from sim.effects.effect import Effect, Stage
    >>> offset = {"offset": Parameter(0.5, "Nm", -50.0, 50.0, "of the torque cell")}
    >>> what_is_wrong(Effect("zero", Stage.MEASUREMENT, ("constant",), offset, "offset"))
    ''
    >>> what_is_wrong(Effect("zero", Stage.MEASUREMENT, ("constant",), 5, "offset"))
    'parameters = 5 is no mapping from names to Parameter'
    """
    if not isinstance(effect.parameters, Mapping) or not all(
        isinstance(name, str) and isinstance(one, Parameter)
        for name, one in effect.parameters.items()
    ):
        return f"parameters = {_short(effect.parameters)} is no mapping from names to Parameter"
    for name, one in effect.parameters.items():
        if wrong := _wrong_parameter(one):
            return f"parameter {name[:40]}: {wrong}"
    checks = {
        "name": (_is_text, "text"),
        "stage": (lambda value: isinstance(value, Stage), "Stage"),
        "forms": (_are_texts, "tuple of texts"),
        "strength": (_is_text, "text"),
        "n_states": (_is_count, "whole number from 0 on"),
        "in_blocks": (lambda value: isinstance(value, bool), "True or False"),
        "irregular": (lambda value: isinstance(value, bool), "True or False"),
        **dict.fromkeys(_FUNCTIONS, (_can_be_called, "function")),
    }
    for name, (holds, expected) in checks.items():
        if not holds(value := getattr(effect, name)):
            return f"{name} = {_short(value)} is no {expected}"
    return ""


def _wrong_parameter(one: Parameter) -> str:
    for name in ("default", "low", "high"):
        value = getattr(one, name)
        if not isinstance(value, Real) or isinstance(value, bool):
            return f"{name} = {_short(value)} is no number"
    for name in ("unit", "meaning"):
        if not _is_text(getattr(one, name)):
            return f"{name} = {_short(getattr(one, name))} is no text"
    return ""


def _is_text(value: object) -> bool:
    return isinstance(value, str)


def _are_texts(value: object) -> bool:
    return isinstance(value, tuple) and all(map(_is_text, value))


def _is_count(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0


def _can_be_called(value: object) -> bool:
    return value is None or callable(value)


def _short(value: object) -> str:
    return repr(value)[:60]
