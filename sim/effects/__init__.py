"""Effects that extend the plain model of the rig, one file each.

A new effect is a file with an ``EFFECT`` of the same name; users' own effects are files anywhere,
read by `noise.base.user_effects`.
"""

from sim.effects.effect import Effect
from sim.parameters import Library

__all__ = ["EFFECTS", "Effect"]

EFFECTS: Library[Effect] = Library(__name__, __path__, "EFFECT", besides=("effect",))
"""Every shipped effect by name."""
