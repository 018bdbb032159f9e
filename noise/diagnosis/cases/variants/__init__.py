"""Further functional forms of every effect, for the diagnosis to know an effect by what it does.

The simulator's own forms are three for each effect; a real rig has none of them. These are others,
many with random shapes, so that what is learnt is the effect and not a formula. They are private
to the diagnosis: their parameters are drawn, nobody sets them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from noise.diagnosis.cases.variants.beams import BEAMS
from noise.diagnosis.cases.variants.delay import DELAY
from noise.diagnosis.cases.variants.disturbance import NOISE
from noise.diagnosis.cases.variants.drive import FLUCTUATION, SHAFT
from noise.diagnosis.cases.variants.elastomer import SOFTENING, VISCOELASTICITY
from noise.diagnosis.cases.variants.gain import GAIN
from noise.diagnosis.cases.variants.hum import HUM
from noise.diagnosis.cases.variants.mount import MOUNT
from noise.diagnosis.cases.variants.overloads import CLIPPING
from noise.diagnosis.cases.variants.plate import PLATE
from noise.diagnosis.cases.variants.pulses import PULSES
from noise.diagnosis.cases.variants.room import ROOM
from noise.diagnosis.cases.variants.scatter import SCATTER
from noise.diagnosis.cases.variants.speed_dependence import STRENGTHENING, WEAKENING
from noise.diagnosis.cases.variants.stick import AGEING, CREEP
from noise.diagnosis.cases.variants.surface import FILM, HEAT

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np

    from noise.diagnosis.cases.variants.common import Recipe
    from sim.effects.effect import Effect

__all__ = ["VARIANTS", "draw_variant"]

VARIANTS: Mapping[str, tuple[Recipe, ...]] = {
    "amplitude_softening": SOFTENING,
    "background_noise": NOISE,
    "beam_modes": BEAMS,
    "channel_delay": DELAY,
    "clipping": CLIPPING,
    "critical_torque_scatter": SCATTER,
    "frictional_heating": HEAT,
    "gain_error": GAIN,
    "mains_hum": HUM,
    "mount_resonance": MOUNT,
    "partial_slip": CREEP,
    "plate_modes": PLATE,
    "room_reflections": ROOM,
    "shaft_compliance": SHAFT,
    "slip_pulse": PULSES,
    "speed_fluctuation": FLUCTUATION,
    "static_ageing": AGEING,
    "transfer_film": FILM,
    "velocity_strengthening": STRENGTHENING,
    "velocity_weakening": WEAKENING,
    "viscoelastic_stiffness": VISCOELASTICITY,
}
"""Recipes by the name of the effect."""


def draw_variant(name: str, strength: float, rng: np.random.Generator) -> Effect:
    """Draw one of an effect's further forms.

    Parameters
    ----------
    name : str
        Of `VARIANTS`.
    strength : float
        From 0, the plain model, to 1, which nobody overlooks [-].
    rng : numpy.random.Generator

    Returns
    -------
    Effect
        Of the effect's name, with the one form that was drawn.

    Examples
    --------
    >>> import numpy as np
    >>> drawn = draw_variant("clipping", 0.5, np.random.default_rng(0))
    >>> drawn.name, len(drawn.forms)
    ('clipping', 1)
    """
    recipes = VARIANTS[name]
    return recipes[int(rng.integers(len(recipes)))](strength, rng)
