"""``bushing-noise effects``: list the effects with their parameters."""

from __future__ import annotations

from argparse import Namespace
from importlib import import_module
from typing import TYPE_CHECKING

from noise.commands.options import Option

if TYPE_CHECKING:
    from sim.effects import Effect


OPTIONS = (Option("names NAME", str, count="*"),)


def run(options: Namespace) -> int:
    """Print the effects."""
    from sim.effects import EFFECTS
    from sim.effects.effect import Stage, effect_named

    stages = list(Stage)
    effects = sorted(
        (effect_named(name, EFFECTS) for name in options.names or EFFECTS),
        key=lambda one: stages.index(one.stage),
    )
    print("\n\n".join(map(_description, effects)))
    return 0


def _description(effect: Effect) -> str:
    """Return a description of an effect, in several lines."""
    about = (import_module(f"sim.effects.{effect.name}").__doc__ or "").partition("\n")[0]
    lines = [f"{effect.name} ({effect.stage})", f"  {about}"]
    if len(effect.forms) > 1:
        lines.append(f"  form={' | '.join(effect.forms)} (default: {effect.forms[0]})")
    for key, one in effect.parameters.items():
        unit = f" {one.unit}" if one.unit not in ("", "1") else ""
        lines.append(
            f"  {key}={one.default:g}{unit}, {one.low:g} to {one.high:g}{unit}: {one.meaning}"
        )
    return "\n".join(lines)
