"""User-defined effects from Python files, for ``--effects`` and `noise.diagnose`.

Errors in the user's code are reported with file, effect and line.
"""

from __future__ import annotations

import sys
import traceback
from collections import ChainMap
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import wraps
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import TYPE_CHECKING, Any

from models.errors import BushingNoiseError, ParameterError
from models.foreign_file import one_line

if TYPE_CHECKING:  # compiled functions take a second to load
    from sim.effects.effect import Effect


def effect_library(paths: Path | Sequence[Path] | None) -> Mapping[str, Effect]:
    """Return the shipped and the user-defined effects by name.

    Parameters
    ----------
    paths : Path or sequence of Path, optional
        Python files to run; each global `Effect` in them is used.

    Returns
    -------
    mapping of str to Effect

    Raises
    ------
    ParameterError
        A file cannot be run or defines no effect, an effect is invalid, or its name is that of a
        shipped effect or of one in another file.

    Examples
    --------
    >>> "slip_pulse" in effect_library(None)
    True
    """
    from sim.effects import EFFECTS

    own: dict[str, Effect] = {}
    for path in [paths] if isinstance(paths, Path) else paths or ():
        for effect in _defined(path):
            where = f"--effects {path}: effect {str(effect.name)[:40]!r}"
            with _error_location(f"{where} is not a valid Effect"):
                checked = _checked_effect(effect, where)
            if effect.name in EFFECTS or effect.name in own:
                other = "a shipped effect" if effect.name in EFFECTS else "defined in another file"
                raise ParameterError(f"{where} is {other} as well; choose a new name")
            own[effect.name] = checked
    return ChainMap(own, EFFECTS) if own else EFFECTS  # type: ignore[arg-type]  # read-only use


def _defined(path: Path) -> list[Effect]:
    """Run a file and return the effects that it defines."""
    from sim.effects import EFFECTS, Effect

    spec = spec_from_file_location(f"_effects_of_{path.stem}", path)
    if spec is None or spec.loader is None or not path.is_file():
        raise ParameterError(f"--effects {path}: no Python file")
    module = module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up there
    with _error_location(f"--effects {path}: cannot be run"):
        spec.loader.exec_module(module)
    effects = {str(one.name): one for one in vars(module).values() if isinstance(one, Effect)}
    own = [one for name, one in effects.items() if one is not EFFECTS.get(name)]
    if not own:
        raise ParameterError(f"--effects {path}: defines no Effect; see the README for an example")
    return own


@contextmanager
def _error_location(where: str) -> Iterator[None]:
    """Prefix errors of the user's code with `where`, and name the line of the user's file."""
    try:
        yield
    except BushingNoiseError as error:
        raise ParameterError(f"{where}: {error}") from None
    except (Exception, SystemExit) as error:
        frames = traceback.extract_tb(error.__traceback__)
        own = [frame for frame in frames if Path(frame.filename).name in where]
        place = f" ({Path(own[-1].filename).name}, line {own[-1].lineno})" if own else ""
        raise ParameterError(
            f"{where}: {type(error).__name__}: {one_line(error)}{place}"
        ) from error


def _checked_effect(effect: Effect, where: str) -> Effect:
    """Check an effect and wrap its functions with `_checked`."""
    from numba.extending import is_jitted

    from sim.contact import HOOK_SIGNATURE
    from sim.effects.effect import Stage

    Stage(effect.stage)
    effect.active({})
    if effect.strength not in effect.parameters:
        raise ValueError(f"strength = {effect.strength!r} is none of its parameters")
    if not any((effect.drive, effect.contact, effect.force, effect.sensors)):
        raise ValueError("needs one of drive, contact, force and sensors")
    if effect.contact is not None:
        if not is_jitted(effect.contact):
            raise ValueError(
                "contact is not compiled; write @numba.njit(sim.contact.HOOK_SIGNATURE) above it"
            )
        if HOOK_SIGNATURE.args not in effect.contact.signatures:
            with _error_location("contact cannot be compiled by HOOK_SIGNATURE"):
                effect.contact.compile(HOOK_SIGNATURE)
    expected: dict[str, Callable[[Any], Any]] = {
        "drive": lambda speed: speed,
        "force": lambda motion: motion.torque,
        "sensors": lambda signals: signals,
        "pack": lambda _: None,
    }
    checked: dict[str, Any] = {
        name: _checked(getattr(effect, name), f"{where}: {name}", like)
        for name, like in expected.items()
        if getattr(effect, name) is not None
    }
    return replace(effect, **checked)


def _checked(
    function: Callable[..., Any], where: str, expected: Callable[[Any], Any]
) -> Callable[..., Any]:
    """Wrap a function: locate its errors and check its result.

    ``expected(first)`` makes an array, or a dict of arrays, of the result's shape from the first
    argument; None is any length.
    """

    @wraps(function)
    def checked(first: Any, *others: object) -> Any:
        with _error_location(where):
            result, like = function(first, *others), expected(first)
            if not isinstance(like, dict):
                _check_array(result, like, "result")
            elif not isinstance(result, dict) or list(result) != list(like):
                raise ParameterError(
                    f"must return a dict of the signals it was given: {', '.join(like)}"
                )
            else:
                for name, signal in like.items():
                    _check_array(result[name], signal, name)
        return result

    return checked


def _check_array(result: Any, like: Any, name: str) -> None:
    """Refuse anything but finite numbers of type float64, as many as in another array."""
    import numpy as np

    shape = (np.size(result),) if like is None else like.shape
    if np.shape(result) != shape or getattr(result, "dtype", None) != np.float64:
        raise ParameterError(f"must return a float64 array of shape {shape} as {name}")
    if not np.isfinite(result).all():
        raise ParameterError(f"must return finite numbers as {name}")
