"""Effects: all that a rig does beyond its friction law, one effect a file.

A new effect is a file with an ``EFFECT`` that is named as the file is; a user's own is a file
anywhere, read by `load_effects`.
"""

import sys
from collections import ChainMap
from collections.abc import Callable, Iterator, Mapping
from importlib.util import module_from_spec, spec_from_file_location
from numbers import Real
from pathlib import Path
from typing import Any

from models.errors import ParameterError
from sim.effects.effect import Effect, Stage
from sim.parameters import Library, Parameter

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
        for field, value, kind in _fields(effect):
            if not isinstance(value, kind) or (isinstance(value, bool) and kind is Real):
                raise ParameterError(
                    f"effects {path}: effect {str(name)[:40]!r}: {field[:60]} = "
                    f"{repr(value)[:60]} is no {_KINDS[kind]}"
                )
        if name in EFFECTS:
            raise ParameterError(f"effects {path}: {name!r} is a shipped effect; choose a new name")
    return ChainMap(own, EFFECTS)  # type: ignore[arg-type]  # nothing writes to it


_KINDS: dict[Any, str] = {
    Mapping: "mapping from names to Parameter",
    Parameter: "Parameter",
    Real: "number",
    str: "text",
    tuple: "tuple of texts",
    Stage: "Stage",
    bool: "True or False",
    Callable | None: "function",
}


def _fields(effect: Effect) -> Iterator[tuple[str, object, Any]]:
    """Fields of an effect, what they hold, and of which kind that is to be."""
    yield "parameters", effect.parameters, Mapping
    for name, one in effect.parameters.items():
        yield f"parameters[{name!r}]", one, Parameter
        for field in ("default", "low", "high"):
            yield f"parameter {name}: {field}", getattr(one, field), Real
        for field in ("unit", "meaning"):
            yield f"parameter {name}: {field}", getattr(one, field), str
    yield "stage", effect.stage, Stage
    yield "forms", effect.forms, tuple
    for form in effect.forms:
        yield "form", form, str
    for field in ("name", "strength"):
        yield field, getattr(effect, field), str
    for field in ("in_blocks", "irregular"):
        yield field, getattr(effect, field), bool
    yield "n_states", effect.n_states, Real
    for field in ("drive", "contact", "pack", "force", "chain", "sensors"):
        yield field, getattr(effect, field), Callable | None
