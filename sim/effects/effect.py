"""Interface of an effect, and its application to blocks of a run.

An effect is a behaviour of a real rig that the plain model lacks. Each is one file with one
`Effect` named ``EFFECT``, and acts in one stage of the signal path. Most have several functional
forms, because the real one is unknown; ``form=NAME`` selects one. At strength zero an effect leaves
the plain model, to rounding.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any

from models.errors import ParameterError
from models.schema import did_you_mean
from models.show import short_repr
from sim.parameters import Parameter as Parameter, resolve

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from models.radiation.impulse_responses import ImpulseResponses
    from models.rig import LawSpec
    from sim.motion import Motion


Values = Mapping[str, float]
Signals = dict[str, "NDArray[np.float64]"]
Memory = dict[str, Any]
Memories = dict[str, Memory]
"""State of effects from block to block, by name of the effect."""

DriveFunction = Callable[["NDArray[np.float64]", float, str, Values, Any], "NDArray[np.float64]"]
ForceFunction = Callable[["Motion", str, Values], "NDArray[np.float64]"]
SensorFunction = Callable[[Signals, float, str, Values, Any], Signals]
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


@short_repr
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
    changes_only : int, optional
        The only entry of the contact (``CREEP`` or ``CRITICAL`` of `sim.contact`) that `contact`
        changes, if there is one: with a law that does not read it the effect cannot act.
    force : callable, optional
        ``force(motion, form, values)`` returns the force of impacts in the anchors' joint [N].
    chain : callable, optional
        ``chain(response, form, values, rng)`` returns changed impulse responses from torque and
        impacts to acceleration and pressure; they may be longer.
    sensors : callable, optional
        ``sensors(signals, rate, form, values, rng)`` returns changed signals by channel name.
    in_blocks : bool
        Whether `drive` and `sensors` can act block by block, as long runs and live designs need.
        Their last argument is then ``memory`` instead of ``rng``: a dictionary with the generator
        as ``rng`` that passes state from block to block; a run in one block has the entry
        ``whole``. Otherwise they act on whole runs only.
    irregular : bool
        Whether it only makes slips differ at random, so that the rig has a version without it
        (`sim.rig_effects.constant_version`).
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
    changes_only: int | None = None
    force: ForceFunction | None = None
    chain: ChainFunction | None = None
    sensors: SensorFunction | None = None
    in_blocks: bool = False
    irregular: bool = False

    @property
    def needs_whole_run(self) -> bool:
        """Whether the effect acts on whole runs only."""
        return not self.in_blocks and (self.drive is not None or self.sensors is not None)

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
        self, speed: NDArray[np.float64], rate: float, memory: Memory
    ) -> NDArray[np.float64]:
        """Return the changed speed of the shaft over the next block [rad/s], shape (n,)."""
        if self.effect.drive is None:
            return speed
        state = memory if self.effect.in_blocks else memory["rng"]
        return self.effect.drive(speed, rate, self.form, self.values, state)

    def apply_sensors(self, signals: Signals, rate: float, memory: Memory) -> Signals:
        """Return the changed signals of the next block at a rate [Hz], by channel."""
        if self.effect.sensors is None:
            return signals
        state = memory if self.effect.in_blocks else memory["rng"]
        return self.effect.sensors(signals, rate, self.form, self.values, state)

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


def initial_memories(
    effects: Sequence[ActiveEffect], seed: int, memories: Memories | None = None
) -> Memories:
    """Return the memory of each effect by name: from `memories`, or a new one with its own rng."""
    import numpy as np

    names = [active.effect.name for active in effects if active.effect.in_blocks]
    initial = {name: {"rng": np.random.default_rng([seed, *name.encode()])} for name in names}
    return initial | {name: memory for name, memory in (memories or {}).items() if name in initial}


def drive_block(
    even: NDArray[np.float64],
    n: int,
    rate: float,
    effects: Sequence[ActiveEffect],
    memories: Memories,
) -> tuple[NDArray[np.float64], Memories]:
    """Apply effects to the speed of the shaft over a block [rad/s], and return their memories.

    Parameters
    ----------
    even : ndarray, shape (m,)
        Speed without the effects [rad/s].
    n : int
        Samples of this block; those beyond are a preview of the next one.
    rate : float
        [Hz]
    effects : sequence of ActiveEffect
    memories : dict of str to dict
        Memories after the block before, by name; not changed.

    Examples
    --------
    >>> import numpy as np
    >>> from sim.effects import EFFECTS
    >>> uneven = [EFFECTS["speed_fluctuation"].active({"frequency": 10.0})]
    >>> start = initial_memories(uneven, 0)
    >>> first, later = drive_block(np.full(9, 5.0), 6, 100.0, uneven, start)
    >>> second, _ = drive_block(np.full(6, 5.0), 6, 100.0, uneven, later)
    >>> bool(np.allclose(first[6:], second[:3]))
    True
    """
    import numpy as np

    memories = deepcopy(memories)
    for active in effects:
        if active.effect.drive is None:
            continue
        memory = memories.get(active.effect.name, {})
        blocks = [active.apply_drive(even[:n], rate, memory)]
        if even.size > n:
            blocks.append(active.apply_drive(even[n:], rate, deepcopy(memory)))
        even = np.concatenate(blocks)
    return even, memories


def sensors_block(
    signals: Signals, rate: float, effects: Sequence[ActiveEffect], memories: Memories
) -> tuple[Signals, Memories]:
    """Apply effects on sensors to the signals of a block, and return their memories.

    Parameters
    ----------
    signals : dict of str to ndarray, shape (n,)
    rate, effects, memories
        As for `drive_block`.

    Examples
    --------
    >>> import numpy as np
    >>> from sim.effects import EFFECTS
    >>> hum = [EFFECTS["mains_hum"].active({"form": "sine", "pressure_level": 94.0})]
    >>> start = initial_memories(hum, 0)
    >>> read, later = sensors_block({"pressure": np.zeros(960)}, 48e3, hum, start)
    >>> round(float(read["pressure"].std()), 2), sorted(later["mains_hum"])
    (1.0, ['pressure', 'rng'])
    """
    memories = deepcopy(memories)
    for active in effects:
        signals = active.apply_sensors(signals, rate, memories.get(active.effect.name, {}))
    return signals, memories
