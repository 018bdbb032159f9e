"""Effects of the user's own, checked, as ``--effects`` and `noise.diagnose` take them.

They are code that the program has not seen: what goes wrong in them is told with the file, the
effect and the line, not as a defect of the program.
"""

from __future__ import annotations

import traceback
from collections import ChainMap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

from models.errors import BushingNoiseError, ParameterError

if TYPE_CHECKING:  # compiled functions take a second to load
    from sim.effects.effect import Effect

_LONGEST_MESSAGE = 300  # letters: those of compilers go on for pages


def effect_library(paths: Path | Sequence[Path] | None) -> Mapping[str, Effect]:
    """Return the shipped effects and the user's own.

    Parameters
    ----------
    paths : Path or sequence of Path, optional
        Python files that define effects. They are run.

    Returns
    -------
    mapping of str to Effect

    Raises
    ------
    ParameterError
        A file cannot be run, what it defines cannot be used as an effect, or two files define one
        of the same name.

    Examples
    --------
    >>> "slip_pulse" in effect_library(None)
    True
    """
    from sim.effects import EFFECTS, load_effects

    own: dict[str, Effect] = {}
    for path in [paths] if isinstance(paths, Path) else paths or ():
        try:
            library = load_effects(path)
        except (ParameterError, SystemExit) as error:
            text = _one_line(error).removeprefix(f"effects {path}: ") or "stops the program"
            raise ParameterError(f"--effects {path}: {text}") from None
        for name in library.keys() - EFFECTS.keys():
            if name in own:
                raise ParameterError(
                    f"--effects {path}: effect {name!r} is defined in another file as well"
                )
            own[name] = _checked_effect(library[name], path)
    return ChainMap(own, EFFECTS) if own else EFFECTS  # type: ignore[arg-type]  # only read


def _checked_effect(effect: Effect, path: Path) -> Effect:
    """Return the effect with its functions checked."""
    where = f"--effects {path}: effect {effect.name!r}"
    if effect.strength not in effect.parameters:
        raise ParameterError(f"{where}: strength = {effect.strength!r} is none of its parameters")
    if not any((effect.drive, effect.contact, effect.force, effect.sensors)):
        raise ParameterError(f"{where}: needs one of drive, contact, force and sensors")
    if effect.contact is not None:
        _compile(effect.contact, where)
    like: dict[str, Callable[[Any], Any]] = {
        "drive": lambda angle: angle,
        "force": lambda motion: motion.torque,
        "sensors": lambda signals: signals,
        "pack": lambda _: None,
    }
    hooks: dict[str, Any] = {
        hook: _checked(function, f"{where}: {hook}", path, like[hook])
        for hook in like
        if (function := getattr(effect, hook)) is not None
    }
    return replace(effect, **hooks)


def _compile(contact: Any, where: str) -> None:
    from numba.extending import is_jitted

    from sim.contact import HOOK_SIGNATURE

    if not is_jitted(contact):
        raise ParameterError(
            f"{where}: contact is not compiled; write @numba.njit(sim.contact.HOOK_SIGNATURE) "
            "above the function"
        )
    if HOOK_SIGNATURE.args in contact.signatures:
        return
    if contact.signatures:
        raise ParameterError(f"{where}: contact has another signature than HOOK_SIGNATURE")
    try:
        contact.compile(HOOK_SIGNATURE)
    except Exception as error:
        raise ParameterError(f"{where}: contact cannot be compiled: {_one_line(error)}") from None


def _checked(
    function: Callable[..., Any], where: str, path: Path, like: Callable[[Any], Any]
) -> Callable[..., Any]:
    """Return a function whose errors name their place; its result is like something given to it."""

    @wraps(function)
    def checked(first: Any, *others: object) -> Any:
        try:
            result = function(first, *others)
        except BushingNoiseError:
            raise
        except Exception as error:
            frames = traceback.extract_tb(error.__traceback__)
            own = [frame for frame in frames if Path(frame.filename).name == path.name]
            place = f"{Path((own or frames)[-1].filename).name}, line {(own or frames)[-1].lineno}"
            raise ParameterError(
                f"{where}: {type(error).__name__}: {_one_line(error)} ({place})"
            ) from error
        if wrong := _fault(result, like(first)):
            raise ParameterError(f"{where} {wrong}")
        return result

    return checked


def _fault(result: Any, like: Any) -> str:
    """Say what is wrong with a result: it has to be an array, or signals, of the same size."""
    import numpy as np

    if isinstance(like, dict):
        if not isinstance(result, dict) or list(result) != list(like):
            return f"must return a dict of the signals it was given: {', '.join(like)}"
        faults = {name: _fault(result[name], signal) for name, signal in like.items()}
        return next((f"{fault} for {name!r}" for name, fault in faults.items() if fault), "")
    shape = (getattr(result if like is None else like, "size", 0),)
    if not isinstance(result, np.ndarray) or result.shape != shape:
        found = getattr(result, "shape", type(result).__name__)
        return f"must return an array of shape {shape}, not {found}"
    if result.dtype != np.float64 or not np.isfinite(result).all():
        return "must return finite numbers of type float64"
    return ""


def _one_line(error: BaseException) -> str:
    text = " ".join(str(error).split())
    return text if len(text) <= _LONGEST_MESSAGE else text[:_LONGEST_MESSAGE] + " ..."
