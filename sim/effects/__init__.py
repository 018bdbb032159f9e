"""Effects: all that a rig does beyond its friction law, one effect a file.

A new effect is a file with an ``EFFECT`` that is named as the file is; a user's own is a file
anywhere, read by `noise.base.user_effects`.
"""

from sim.effects.effect import Effect
from sim.parameters import Library

__all__ = ["EFFECTS", "Effect"]

EFFECTS: Library[Effect] = Library(__name__, __path__, "EFFECT", besides=("effect",))
"""Every shipped effect by name."""
