"""Effects: all that a rig does beyond its friction law, one effect a file.

A new effect is a file with an ``EFFECT`` that is named as the file is; a user's own is a file
anywhere, read by `load_effects`.
"""

import sys
from collections import ChainMap
from collections.abc import Mapping
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

from models.errors import ParameterError
from sim.effects.effect import Effect, Stage
from sim.parameters import Library

__all__ = ["EFFECTS", "Effect", "load_effects"]

EFFECTS: Library[Effect] = Library(__name__, __path__, "EFFECT", besides=("effect",))
"""Every shipped effect by name."""


def load_effects(path: str | Path) -> Mapping[str, Effect]:
    """Return the shipped effects and those that a Python file of the user's own defines.

    Parameters
    ----------
    path : path-like
        Every `Effect` among the file's global names is taken. The file is run.

    Raises
    ------
    ParameterError
        The file cannot be run, defines no effect, one that is declared in other types than
        `Effect` has, or one with the name of a shipped one.
    """
    path = Path(path)
    spec = spec_from_file_location(f"_effects_of_{path.stem}", path)
    if spec is None or spec.loader is None or not path.is_file():
        raise ParameterError(f"effects {path}: no Python file")
    module = module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up there
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        raise ParameterError(
            f"effects {path}: cannot be run: {type(error).__name__}: {error}"
        ) from error
    found = {str(one.name): one for one in vars(module).values() if isinstance(one, Effect)}
    own = {name: value for name, value in found.items() if value is not EFFECTS.get(name)}
    if not own:
        raise ParameterError(f"effects {path}: defines no Effect; see the README for an example")
    for name, effect in own.items():
        try:
            _try(effect)
        except (AttributeError, LookupError, TypeError, ValueError) as error:
            raise ParameterError(
                f"effects {path}: effect {name[:40]!r} is not declared as Effect asks: {error}"
            ) from error
        if name in EFFECTS:
            raise ParameterError(f"effects {path}: {name!r} is a shipped effect; choose a new name")
    return ChainMap(own, EFFECTS)  # type: ignore[arg-type]  # nothing writes to it


def _try(effect: Effect) -> None:
    """Raise whatever comes of a declaration of other types than `Effect` has."""
    if not (effect.name.strip() and effect.forms):
        raise ValueError("name or forms is empty")
    Stage(effect.stage)
    effect.active({})
    for name in ("drive", "contact", "pack", "force", "chain", "sensors"):
        function = getattr(effect, name)
        if function is not None and not callable(function):
            raise TypeError(f"{name} = {function!r} is no function")
