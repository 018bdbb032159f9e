"""Runs of models of a rig, each made of what earlier ones have made already.

A fit runs one rig with small changes hundreds of times. What a model shares with the one before is
not made again: an effect on sensors leaves the motion as it is, and the other channels; one on the
structure leaves the motion.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from threading import Lock
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from models.condition import known_condition
from models.radiation.impulse_responses import ImpulseResponses
from models.recording import Channel, Recording
from models.rig import Fit, LawSpec, Rig
from models.sensors import Sensor
from noise.base.arrays import Array
from noise.diagnosis.signature import KINDS, signature
from noise.diagnosis.simulated.repeats import (
    Scatter,
    condition_key,
    perturb_run,
    plan_repeat,
    record,
    repeat_motion,
)
from noise.diagnosis.simulated.transfer_functions import (
    TransferFunctionCache,
    chain_changes,
    chain_of,
    n_closed,
    radiated_sound,
)
from sim.acquisition import Acquisition, decimate_sensed, digitise
from sim.chain import apply_chain_effects
from sim.effects.effect import ActiveEffect, Effect, Signals
from sim.motion import Motion
from sim.plan import DIAGNOSIS, Plan
from sim.run import apply_sensor_effects, sensor_signals

Changed = tuple[Mapping[str, NDArray[np.complex128]], ImpulseResponses | None]
T = TypeVar("T")

_EXACT = Scatter(0.0, 0.0, 0.0, 0.0)

_COARSE = 2e-5
"""Error of a step of runs without scatter [-]: they are compared with each other; assumed."""

_CACHED = 24
"""Responses and signals in the cache."""

_ROOM, _BYTES = 6e8, 72
"""Motions in the cache, and a sample of one [byte]; one of a second at 90 kHz takes 6.5e6."""


OFFSETS = (
    "elastomer_stiffness", "critical_torque", "kinetic_torque", "damping", "elastomer_inertia",
)  # fmt: skip
"""Parameters of the rig file that may be off in all recordings of a case."""


def with_offsets(rig: Rig, offsets: Mapping[str, float]) -> Rig:
    """Return a rig whose parameters differ by factors, in all its fits.

    Parameters
    ----------
    rig : Rig
    offsets : mapping of str to float
        Factors [-] by names of `OFFSETS`.
    """
    factor = dict.fromkeys(OFFSETS, 1.0) | dict(offsets)

    def changed(fit: Fit) -> Fit:
        kinetic = fit.kinetic_torque * factor["kinetic_torque"]
        return replace(
            fit,
            elastomer_stiffness=fit.elastomer_stiffness * factor["elastomer_stiffness"],
            critical_torque=max(fit.critical_torque * factor["critical_torque"], kinetic),
            kinetic_torque=kinetic,
            damping={support: c * factor["damping"] for support, c in fit.damping.items()},
        )

    return replace(
        rig,
        fits=tuple(changed(fit) for fit in rig.fits),
        elastomer_inertia=rig.elastomer_inertia * factor["elastomer_inertia"],
    )


@dataclass(frozen=True)
class Model:
    """A rig with offsets and effects.

    Parameters
    ----------
    offsets : tuple of float
        Logarithms of the factors on `OFFSETS`.
    effects : tuple of LawSpec
        Beyond those that the rig file lists; one that it lists as well takes its place.
    """

    offsets: tuple[float, ...] = (0.0,) * len(OFFSETS)
    effects: tuple[LawSpec, ...] = ()

    @property
    def factors(self) -> dict[str, float]:
        """Factors on `OFFSETS` by name [-]."""
        return {name: math.exp(x) for name, x in zip(OFFSETS, self.offsets, strict=True)}


def with_effects(rig: Rig, effects: Sequence[LawSpec]) -> Rig:
    """Return a rig with further effects; one that it lists already is replaced.

    Examples
    --------
    >>> from models.rig import LawSpec
    >>> from models.rig_file import load_material_rig
    >>> more = LawSpec("critical_torque_scatter", {"scatter": 0.6})
    >>> list(map(str, with_effects(load_material_rig("natural-rubber"), [more]).effects))
    ['critical_torque_scatter:scatter=0.6']
    """
    named = {spec.name for spec in effects}
    others = tuple(spec for spec in rig.effects if spec.name not in named)
    return replace(rig, effects=(*others, *effects))


class ModelRuns:
    """Runs of models of one rig.

    Parameters
    ----------
    rig : Rig
    library : mapping of str to Effect
    forms : dict of (str, str) to Effect
        Further forms of effects, by the name of the effect and their own.
    """

    def __init__(
        self, rig: Rig, library: Mapping[str, Effect], forms: Mapping[tuple[str, str], Effect]
    ) -> None:
        self.rig, self.library, self._forms = rig, library, forms
        self.transfer_functions = TransferFunctionCache(rig, library)
        self._responses: _Cache[ImpulseResponses] = _Cache()
        self._changed: _Cache[Changed] = _Cache()
        self._motions: _Cache[Motion] = _Cache()
        self._signals: _Cache[Signals] = _Cache()

    def simulated(
        self, model: Model, template: Recording, seed: int, scatter: Scatter | None = None
    ) -> Recording:
        """Simulate a recording by a model, at the condition, rate and length of another.

        Parameters
        ----------
        model : Model
        template : Recording
        seed : int
            Of the scatter, of effects that scatter, and of the sensors' noise.
        scatter : Scatter, optional
            By default that of repeats.

        Raises
        ------
        ParameterError
            The model cannot be simulated.
        """
        scatter = scatter or Scatter()
        return record(
            self._sensed(model, template, seed, scatter), template.rate, template.condition,
            np.random.default_rng([seed, 3]), scatter,
            decimation=DIAGNOSIS.decimation(template.rate), sensors=self.rig.sensors,
        )  # fmt: skip

    def noise_free_signature(self, model: Model, template: Recording, seed: int) -> Array:
        """Return the signature of a run without scatter, and without noise of ideal sensors.

        Parameters
        ----------
        model : Model
        template : Recording
        seed : int
            Of effects that are chance.

        Returns
        -------
        ndarray, shape (n_values,)
            As of `noise.diagnosis.signature.signature`.

        Raises
        ------
        ParameterError
            The model cannot be simulated.
        """
        through = Acquisition(rate=template.rate, sensors=self.rig.sensors)
        read = self._sensed(model, template, seed, _EXACT)
        decimation = DIAGNOSIS.decimation(template.rate)
        kinds = [kind for kind in KINDS if template.first(kind) is not None]
        rows = []
        for kind in kinds:
            sensor = through.sensors.of(kind)
            row = decimate_sensed(read[kind], decimation, decimation * template.rate, sensor)
            if sensor != Sensor():
                row = digitise(row, kind, through, np.random.default_rng([seed, 3]))
            rows.append(row)
        channels = tuple(Channel(kind) for kind in kinds)
        return signature(replace(template, samples=np.stack(rows), channels=channels))

    def _sensed(self, model: Model, template: Recording, seed: int, scatter: Scatter) -> Signals:
        """Return signals after the effects on sensors, before the sensors themselves."""
        specs = with_effects(self.rig, model.effects).effects
        active = [self.effect_of(spec).active(spec.parameters) for spec in specs]
        effects, fine = [one for one in active if not one.is_off], DIAGNOSIS.rate(template.rate)
        signals = self._radiated(model, effects, template, fine, seed, scatter)
        return apply_sensor_effects(signals, effects, fine, np.random.default_rng([seed, 2]))

    def effect_of(self, spec: LawSpec) -> Effect:
        """Return the effect of a name, in a form of the simulator's own or a further one."""
        further = self._forms.get((spec.name, str(spec.parameters.get("form"))))
        return self.library[spec.name] if further is None else further

    def _radiated(
        self,
        model: Model,
        effects: Sequence[ActiveEffect],
        template: Recording,
        fine: float,
        seed: int,
        scatter: Scatter,
    ) -> Signals:
        """Return signals before the sensors."""
        on_paths = [a for a in effects if a.effect.chain is not None or a.effect.force is not None]
        on_motion = [
            a for a in effects if a.effect.contact is not None or a.effect.drive is not None
        ]
        at_rest = (condition_key(template), template.condition.temperature)
        of_motion = (at_rest, seed, scatter, model.offsets, _key(on_motion))

        def radiated() -> Signals:
            rig, rng = with_offsets(self.rig, model.factors), np.random.default_rng([seed, 0])
            once, at = perturb_run(rig, known_condition(template.condition), scatter, rng)
            plan = plan_repeat(once, at, on_motion, rate=fine, seconds=template.duration)
            tolerance = _COARSE if scatter == _EXACT else None

            self._motions.most = int(_ROOM / (_BYTES * (plan.n_settling + plan.n_recorded)))
            motion = self._motions.get(
                of_motion,
                lambda: repeat_motion(plan, np.random.default_rng([seed, 1]), tolerance),
            )
            changes, paths = self._changes(plan, on_paths)
            at_condition = self.transfer_functions.at(plan.interference, plan.support_stiffness)
            sound = radiated_sound(motion, plan, self.rig, at_condition, changes, paths, on_paths)
            return sensor_signals(motion, sound, plan.n_settling)

        return self._signals.get((*of_motion, _key(on_paths)), radiated)

    def _changes(self, plan: Plan, effects: Sequence[ActiveEffect]) -> Changed:
        """Tell what effects change about the ways from the torque, and the ways of pulses."""
        if not effects:
            return {}, None
        at, length = (plan.interference, plan.support_stiffness), n_closed(plan)

        def made() -> Changed:
            plain = self._responses.get(
                (*at, plan.rate),
                lambda: chain_of(
                    self.rig, *at, self.transfer_functions.at(*at), plan.rate, impacts=True
                ),
            )
            changed = apply_chain_effects(plain, effects, np.random.default_rng(0))
            return chain_changes(plain, changed, length), changed

        return self._changed.get((*at, plan.rate, length, _key(effects)), made)


class _Cache(Generic[T]):
    """What was made last, by what it was made of; several threads may ask for it."""

    def __init__(self, most: int = _CACHED) -> None:
        self._made: dict[object, T] = {}
        self.most, self._lock = most, Lock()

    def get(self, key: object, make: Callable[[], T]) -> T:
        """Return what was made under a key, or make it."""
        with self._lock:
            if key in self._made:
                return self._made[key]
        made = make()
        with self._lock:
            while len(self._made) >= max(self.most, 1):
                self._made.pop(next(iter(self._made)))
            self._made[key] = made
        return made


def _key(effects: Sequence[ActiveEffect]) -> tuple[object, ...]:
    return tuple((a.effect.name, a.form, tuple(a.values.items())) for a in effects)
