"""The small interface behind which every effect stands.

An effect is what a real rig does and the plain model does not. It is one file with one `Effect`
named ``EFFECT``, and acts in one stage of the signal's way. Most come in several functional forms,
because nobody knows the form that the real one has; ``form=NAME`` chooses. At strength zero an
effect is the plain model to rounding.
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
"""What effects keep from block to block, by their names."""

DriveFunction = Callable[["NDArray[np.float64]", float, str, Values, Any], "NDArray[np.float64]"]
ForceFunction = Callable[["Motion", str, Values], "NDArray[np.float64]"]
SensorFunction = Callable[[Signals, float, str, Values, Any], Signals]
ChainFunction = Callable[
    ["ImpulseResponses", str, Values, "np.random.Generator"], "ImpulseResponses"
]
PackFunction = Callable[[str, Values, "np.random.Generator"], "NDArray[np.float64]"]


class Stage(StrEnum):
    """The stages of a signal's way, in its order."""

    DRIVE = "drive"
    FRICTION = "friction"
    STRUCTURE = "structure"
    RADIATION = "radiation"
    MEASUREMENT = "measurement"


@short_repr
@dataclass(frozen=True)
class Effect:
    """An effect: what it is called, where it acts, what can be set, and how it acts.

    Parameters
    ----------
    name : str
    stage : Stage
    forms : tuple of str
        Functional forms, the first being the default.
    parameters : mapping of str to Parameter
    strength : str
        The parameter that, at zero, leaves the plain model.
    drive : callable, optional
        ``drive(speed, rate, form, values, rng)``: another shaft speed [rad/s].
    contact : compiled function, optional
        Changes the contact while the motion is solved, by `sim.contact.HOOK_SIGNATURE`.
    pack : callable, optional
        ``pack(form, values, rng)``: the numbers that `contact` reads. By default the values of all
        parameters in their order, and after them the place of the form among `forms`.
    n_states : int
        Inner states of `contact`, zero at the start.
    changes_only : int, optional
        The entry of the contact (``CREEP`` or ``CRITICAL`` of `sim.contact`) that `contact` changes
        where it changes no other: with a law that does not read it the effect cannot act.
    force : callable, optional
        ``force(motion, form, values)``: force of blows in the anchors' joint [N].
    chain : callable, optional
        ``chain(response, form, values, rng)``: other impulse responses from torque and blows to
        acceleration and pressure; they may be longer.
    sensors : callable, optional
        ``sensors(signals, rate, form, values, rng)``: other signals, by name of the channel.
    in_blocks : bool
        Whether `drive` and `sensors` act on a run block by block, as long runs and live designs
        need it. They are then given ``memory`` in place of ``rng``: a dictionary that has the
        generator as ``rng``, is the block's before, and keeps what the next block needs; a run in
        one block has the entry ``whole``. Else they act on runs in one block alone.
    irregular : bool
        Whether it does nothing but make one slip differ from the next by chance, so that the rig
        has a version without (`sim.rig_effects.constant_version`).
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
        """Whether it acts on runs in one block alone."""
        return not self.in_blocks and (self.drive is not None or self.sensors is not None)

    def active(self, given: Mapping[str, float | str]) -> ActiveEffect:
        """Return the effect with these parameters, the others at their defaults.

        Raises
        ------
        ParameterError
            A parameter or form that it does not have, or a value out of range.
        """
        values = dict(given)
        form = str(values.pop("form", self.forms[0]))
        if form not in self.forms:
            raise ParameterError(
                f"effect {self.name!r}: form {form!r} is unknown; there are {', '.join(self.forms)}"
            )
        return ActiveEffect(self, form, resolve(f"effect {self.name!r}", self.parameters, values))


@dataclass(frozen=True)
class ActiveEffect:
    """An effect with a form and the values of all its parameters."""

    effect: Effect
    form: str
    values: Values

    @property
    def is_off(self) -> bool:
        """Whether its strength is zero."""
        return self.values[self.effect.strength] == 0.0

    def driven(
        self, speed: NDArray[np.float64], rate: float, memory: Memory
    ) -> NDArray[np.float64]:
        """Speed of the shaft as the effect makes it over the next block [rad/s], shape (n,)."""
        if self.effect.drive is None:
            return speed
        given = memory if self.effect.in_blocks else memory["rng"]
        return self.effect.drive(speed, rate, self.form, self.values, given)

    def sensed(self, signals: Signals, rate: float, memory: Memory) -> Signals:
        """Signals of the next block, at a rate [Hz], as the effect makes sensors read them."""
        if self.effect.sensors is None:
            return signals
        given = memory if self.effect.in_blocks else memory["rng"]
        return self.effect.sensors(signals, rate, self.form, self.values, given)

    def packed(self, rng: np.random.Generator) -> NDArray[np.float64]:
        """Return the numbers that its compiled function reads, shape (n,), units by the effect."""
        effect = self.effect
        if effect.pack is not None:
            return effect.pack(self.form, self.values, rng)
        import numpy as np  # help names the effects, and has no need of it

        return np.array([*self.values.values(), effect.forms.index(self.form)])


def activated(specs: tuple[LawSpec, ...], effects: Mapping[str, Effect]) -> list[ActiveEffect]:
    """Return the effects that specifications name, without those of strength zero.

    Raises
    ------
    ParameterError
        An effect that is unknown, or one that is named twice.
    """
    found: list[ActiveEffect] = []
    names = [spec.name for spec in specs]
    for spec in specs:
        effect = effect_named(spec.name, effects)
        if names.count(spec.name) > 1:
            raise ParameterError(f"effect {spec.name!r} is named {names.count(spec.name)} times")
        active = effect.active(spec.parameters)
        if not active.is_off:
            found.append(active)
    return found


def effect_named(name: str, effects: Mapping[str, Effect]) -> Effect:
    """Return an effect by its name, or what a condition adds to a rig's, which no library has.

    Raises
    ------
    ParameterError
        There is none; the message has those that there are.
    """
    if name in effects:
        return effects[name]
    from sim.temperature import FRICTION_SHIFT  # itself an effect

    if name == FRICTION_SHIFT.name:
        return FRICTION_SHIFT
    raise ParameterError(
        f"effect {name!r} is unknown{did_you_mean(name, sorted(effects))}; there are "
        f"{', '.join(sorted(effects))}"
    )


def begun(effects: Sequence[ActiveEffect], seed: int, kept: Memories | None = None) -> Memories:
    """Return the memory, by name, that each effect goes on with; each has its own random numbers.

    Effects that have none in `kept` begin.
    """
    import numpy as np

    names = [active.effect.name for active in effects if active.effect.in_blocks]
    begin = {name: {"rng": np.random.default_rng([seed, *name.encode()])} for name in names}
    return begin | {name: memory for name, memory in (kept or {}).items() if name in begin}


def drive_block(
    even: NDArray[np.float64],
    n: int,
    rate: float,
    effects: Sequence[ActiveEffect],
    memories: Memories,
) -> tuple[NDArray[np.float64], Memories]:
    """Speed of the shaft over a block as effects make it [rad/s], and what they keep of it.

    Parameters
    ----------
    even : ndarray, shape (m,)
        Speed as it is set [rad/s].
    n : int
        Samples of this block; those beyond are seen now, and come again.
    rate : float
        [Hz]
    effects : sequence of ActiveEffect
    memories : dict of str to dict
        What they kept of the block before, by name; they stay as they are.

    Examples
    --------
    >>> import numpy as np
    >>> from sim.effects import EFFECTS
    >>> uneven = [EFFECTS["speed_fluctuation"].active({"frequency": 10.0})]
    >>> start = begun(uneven, 0)
    >>> first, kept = drive_block(np.full(9, 5.0), 6, 100.0, uneven, start)
    >>> second, _ = drive_block(np.full(6, 5.0), 6, 100.0, uneven, kept)
    >>> bool(np.allclose(first[6:], second[:3]))
    True
    """
    import numpy as np

    kept = deepcopy(memories)
    for active in effects:
        if active.effect.drive is None:
            continue
        memory = kept.get(active.effect.name, {})
        blocks = [active.driven(even[:n], rate, memory)]
        if even.size > n:
            blocks.append(active.driven(even[n:], rate, deepcopy(memory)))
        even = np.concatenate(blocks)
    return even, kept


def sensors_block(
    signals: Signals, rate: float, effects: Sequence[ActiveEffect], memories: Memories
) -> tuple[Signals, Memories]:
    """Signals of a block as effects on sensors change them, and what these keep of it.

    Parameters
    ----------
    signals : dict of str to ndarray, shape (n,)
    rate, effects, memories
        As of `drive_block`.

    Examples
    --------
    >>> import numpy as np
    >>> from sim.effects import EFFECTS
    >>> hum = [EFFECTS["mains_hum"].active({"form": "sine", "pressure_level": 94.0})]
    >>> start = begun(hum, 0)
    >>> read, kept = sensors_block({"pressure": np.zeros(960)}, 48e3, hum, start)
    >>> round(float(read["pressure"].std()), 2), sorted(kept["mains_hum"])
    (1.0, ['pressure', 'rng'])
    """
    kept = deepcopy(memories)
    for active in effects:
        signals = active.sensed(signals, rate, kept.get(active.effect.name, {}))
    return signals, kept
