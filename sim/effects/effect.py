"""Interface of an effect.

An effect is a behaviour of a real rig that the plain model lacks. Each is one file with one
`Effect` named ``EFFECT``, and acts in one stage of the signal path. Most have several functional
forms, because the real one is unknown; ``form=NAME`` selects one. At strength zero an effect leaves
the plain model, to rounding.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any

from models.errors import ParameterError
from models.schema import did_you_mean
from sim.parameters import Parameter as Parameter, resolve

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from models.radiation.impulse_responses import ImpulseResponses
    from models.rig import LawSpec
    from sim.motion import Motion


Values = Mapping[str, float]
Signals = dict[str, "NDArray[np.float64]"]

DriveFunction = Callable[
    ["NDArray[np.float64]", float, str, Values, "np.random.Generator"], "NDArray[np.float64]"
]
ForceFunction = Callable[["Motion", str, Values], "NDArray[np.float64]"]
SensorFunction = Callable[[Signals, float, str, Values, "np.random.Generator"], Signals]
ChainFunction = Callable[
    ["ImpulseResponses", str, Values, "np.random.Generator"], "ImpulseResponses"
]
PackFunction = Callable[[str, Values, "np.random.Generator"], "NDArray[np.float64]"]


class Stage(StrEnum):
    """Stages of the signal path, in order."""

    DRIVE = "drive"
    FRICTION = "friction"
    STRUCTURE = "structure"
    RADIATION = "radiation"
    MEASUREMENT = "measurement"


@dataclass(frozen=True)
class Effect:
    """Effect: its name, stage, forms, parameters and functions.

    Parameters
    ----------
    name : str
    stage : Stage
    forms : tuple of str
        Functional forms, the first being the default.
    parameters : mapping of str to Parameter
    strength : str
        Name of the parameter that leaves the plain model at zero.
    drive : callable, optional
        ``drive(speed, rate, form, values, rng)`` returns the changed shaft speed [rad/s].
    contact : compiled function, optional
        Function that changes the contact during the solution, by `sim.contact.HOOK_SIGNATURE`.
    pack : callable, optional
        ``pack(form, values, rng)`` returns the numbers that `contact` reads; by default the values
        of all parameters in order, followed by the index of the form among `forms`.
    n_states : int
        Number of inner states of `contact`, zero at the start.
    of_true_stick : bool
        Whether `contact` changes the creep of true stick alone, which laws with an inner state do
        not read.
    force : callable, optional
        ``force(motion, form, values)`` returns the force of impacts in the anchors' joint [N].
    chain : callable, optional
        ``chain(response, form, values, rng)`` returns changed impulse responses from torque and
        impacts to acceleration and pressure; they may be longer.
    sensors : callable, optional
        ``sensors(signals, rate, form, values, rng)`` returns changed signals by channel name.
    irregular : bool
        Whether it only makes slips differ at random, so that the rig has a version without it
        (`sim.effects.constant_version`).
    """

    name: str
    stage: Stage
    forms: tuple[str, ...]
    parameters: Mapping[str, Parameter]
    strength: str
    drive: DriveFunction | None = None
    contact: Any = None
    pack: PackFunction | None = None
    n_states: int = 0
    of_true_stick: bool = False
    force: ForceFunction | None = None
    chain: ChainFunction | None = None
    sensors: SensorFunction | None = None
    irregular: bool = False

    @property
    def needs_whole_run(self) -> bool:
        """Whether the effect acts on whole runs only, and not on a live simulation."""
        return self.drive is not None or self.sensors is not None

    def active(self, parameters: Mapping[str, float | str]) -> ActiveEffect:
        """Return the effect with parameters set; the others have their defaults.

        Raises
        ------
        ParameterError
            The effect has no such parameter or form, or a value is out of range.
        """
        values = dict(parameters)
        form = str(values.pop("form", self.forms[0]))
        if form not in self.forms:
            raise ParameterError(
                f"effect {self.name!r}: form {form!r} is unknown; there are {', '.join(self.forms)}"
            )
        return ActiveEffect(self, form, resolve(f"effect {self.name!r}", self.parameters, values))


@dataclass(frozen=True)
class ActiveEffect:
    """Effect with its form and the values of all its parameters."""

    effect: Effect
    form: str
    values: Values

    @property
    def is_off(self) -> bool:
        """Whether the strength is zero."""
        return self.values[self.effect.strength] == 0.0

    def apply_drive(
        self, speed: NDArray[np.float64], rate: float, rng: np.random.Generator
    ) -> NDArray[np.float64]:
        """Return the changed speed of the shaft over a run [rad/s], shape (n,)."""
        if self.effect.drive is None:
            return speed
        return self.effect.drive(speed, rate, self.form, self.values, rng)

    def apply_sensors(self, signals: Signals, rate: float, rng: np.random.Generator) -> Signals:
        """Return the changed signals of a run at a rate [Hz], by channel."""
        if self.effect.sensors is None:
            return signals
        return self.effect.sensors(signals, rate, self.form, self.values, rng)

    def packed(self, rng: np.random.Generator) -> NDArray[np.float64]:
        """Return the numbers that the compiled function reads, shape (n,), units by the effect."""
        effect = self.effect
        if effect.pack is not None:
            return effect.pack(self.form, self.values, rng)
        import numpy as np  # not imported by `--help`, which lists the effects

        return np.array([*self.values.values(), effect.forms.index(self.form)])


def activated(specs: tuple[LawSpec, ...], effects: Mapping[str, Effect]) -> list[ActiveEffect]:
    """Return the active effects of specifications, without those of strength zero.

    Raises
    ------
    ParameterError
        An effect is unknown, or named twice.
    """
    effects_on: list[ActiveEffect] = []
    names = [spec.name for spec in specs]
    for spec in specs:
        effect = effect_named(spec.name, effects)
        if names.count(spec.name) > 1:
            raise ParameterError(f"effect {spec.name!r} is named {names.count(spec.name)} times")
        active = effect.active(spec.parameters)
        if not active.is_off:
            effects_on.append(active)
    return effects_on


def effect_named(name: str, effects: Mapping[str, Effect]) -> Effect:
    """Return an effect by its name, including the one that a temperature adds to a rig.

    Raises
    ------
    ParameterError
        There is none; the message lists the known ones.
    """
    if name in effects:
        return effects[name]
    from sim.temperature import FRICTION_SHIFT  # imports this module

    if name == FRICTION_SHIFT.name:
        return FRICTION_SHIFT
    raise ParameterError(
        f"effect {name!r} is unknown{did_you_mean(name, sorted(effects))}; there are "
        f"{', '.join(sorted(effects))}"
    )
