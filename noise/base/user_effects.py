"""Effects of the user's own, checked, as ``--effects`` and `noise.diagnose` take them.

They are code that the program has not seen, so what they return is checked, and what goes wrong in
them is told with the file, the effect and the line, not as a defect of the program.
"""

from __future__ import annotations

import traceback
from collections import ChainMap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from models.errors import BushingNoiseError, ParameterError

if TYPE_CHECKING:
    from sim.effects.effect import Effect, Signals
    from sim.motion import Motion

    _Result = TypeVar("_Result")


_LONGEST_MESSAGE = 300
"""Messages of compilers go on for pages."""


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
    from sim.effects import EFFECTS

    own: dict[str, Effect] = {}
    for path in [paths] if isinstance(paths, Path) else paths or ():
        for name, effect in _own_effects(path).items():
            if name in own:
                raise ParameterError(
                    f"--effects {path}: effect {name!r} is defined in another file as well"
                )
            own[name] = _guarded(effect, path)
    return ChainMap(own, EFFECTS) if own else EFFECTS  # type: ignore[arg-type]  # only read


def _own_effects(path: Path) -> dict[str, Effect]:
    from sim.effects import EFFECTS, load_effects

    try:
        library = load_effects(path)
    except (ParameterError, SystemExit) as error:
        text = _one_line(error) or "stops the program"
        raise ParameterError(
            f"--effects {path}: {text.removeprefix(f'effects {path}: ')}"
        ) from None
    return {name: effect for name, effect in library.items() if name not in EFFECTS}


def _guarded(effect: Effect, path: Path) -> Effect:
    """Return the effect with its functions checked."""
    where = f"--effects {path}: effect {effect.name!r}"
    if not effect.forms:
        raise ParameterError(f"{where}: forms is empty; name at least one")
    if effect.strength not in effect.parameters:
        raise ParameterError(f"{where}: strength = {effect.strength!r} is none of its parameters")
    if not any((effect.drive, effect.contact, effect.force, effect.sensors)):
        raise ParameterError(f"{where}: needs one of drive, contact, force and sensors")
    if effect.contact is not None:
        _compile(effect.contact, where)
    return replace(
        effect,
        drive=_checked(effect.drive, f"{where}: drive", path, _like_first),
        force=_checked(effect.force, f"{where}: force", path, _like_torque),
        sensors=_checked(effect.sensors, f"{where}: sensors", path, _same_signals),
        pack=_checked(effect.pack, f"{where}: pack", path, _numbers),
    )


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
    function: Callable[..., _Result] | None,
    where: str,
    path: Path,
    fault: Callable[[tuple[object, ...], object], str],
) -> Callable[..., _Result] | None:
    """Return a function that tells errors with their place, and what is wrong with its result."""
    if function is None:
        return None

    @wraps(function)
    def checked(*arguments: object) -> _Result:
        try:
            result = function(*arguments)
        except BushingNoiseError:
            raise
        except Exception as error:
            raise ParameterError(
                f"{where}: {type(error).__name__}: {_one_line(error)} ({_place(error, path)})"
            ) from error
        if wrong := fault(arguments, result):
            raise ParameterError(f"{where} {wrong}")
        return result

    return checked


def _place(error: Exception, path: Path) -> str:
    """Return the last line of the user's file on the way to an error."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if Path(frame.filename).name == path.name]
    last = (own or frames)[-1]
    return f"{Path(last.filename).name}, line {last.lineno}"


def _array_fault(result: object, size: int) -> str:
    import numpy as np

    if not isinstance(result, np.ndarray) or result.shape != (size,):
        shape = getattr(result, "shape", type(result).__name__)
        return f"must return an array of shape ({size},), not {shape}"
    if result.dtype != np.float64 or not np.isfinite(result).all():
        return "must return finite numbers of type float64"
    return ""


def _like_first(arguments: tuple[object, ...], result: object) -> str:
    return _array_fault(result, arguments[0].size)  # type: ignore[attr-defined]


def _like_torque(arguments: tuple[object, ...], result: object) -> str:
    motion: Motion = arguments[0]  # type: ignore[assignment]
    return _array_fault(result, motion.torque.size)


def _same_signals(arguments: tuple[object, ...], result: object) -> str:
    given: Signals = arguments[0]  # type: ignore[assignment]
    if not isinstance(result, dict) or list(result) != list(given):
        return f"must return a dict of the signals it was given: {', '.join(given)}"
    for name, signal in given.items():
        if wrong := _array_fault(result[name], signal.size):
            return f"{wrong} for {name!r}"
    return ""


def _numbers(_arguments: tuple[object, ...], result: object) -> str:
    size = getattr(result, "size", 0)
    return _array_fault(result, size)


def _one_line(error: BaseException) -> str:
    text = " ".join(str(error).split())
    return text if len(text) <= _LONGEST_MESSAGE else text[:_LONGEST_MESSAGE] + " ..."
