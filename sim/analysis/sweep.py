"""Sweep over thousands of operating conditions in one call, on all cores.

The plain model (true stick, constant torques, constant speed) needs nothing of Python between its
runs: whole chunks of runs are one compiled call each. All other laws, effects and ways of turning
go run by run. Threads serve both, since compiled code lets others run; a run depends on nothing
but its own condition and its own seed, which is counted off by its position, so results are the
same bit for bit whatever the number of workers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from joblib import Parallel, delayed

from models.errors import ParameterError
from models.rig import Rig
from models.show import short_repr
from sim.acquisition import Acquisition, sample
from sim.analysis.sweep_features import FEATURES, motion_features, plain_features
from sim.analysis.sweep_systems import packed_systems
from sim.analysis.swept import SweptFeatures
from sim.effects import EFFECTS
from sim.effects.effect import activated
from sim.friction import friction_law
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed
from sim.solvers.free_motion import extended, parts_of_a_step

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from sim.effects.effect import Effect
    from sim.motion import Motion
    from sim.shaft import ShaftMotion

__all__ = ["FEATURES", "Sweep"]

_CONDITIONS = ("rig", "speed", "interference", "support_stiffness")
"""What may differ between runs."""

_CHUNK = 64
"""Runs of the plain model in one compiled call."""


@short_repr
@dataclass(frozen=True, eq=False)
class Sweep:
    """Many conditions of one or several rigs.

    Parameters
    ----------
    rig : Rig or sequence of Rig
    speed : array_like, or one or several ShaftMotion
        Constant speeds [rad/s], or other ways of turning.
    interference, support_stiffness : array_like
        [m] and [Nm/rad]. They, `rig` and `speed` are broadcast against each other.
    seconds, settling : float
        How long each run is looked at, and how long it has run before, from rest [s].
    rate : float
        Of the samples [Hz].
    library : mapping of str to Effect
        Effects that the rigs' can be found among.
    seed : int
        Of effects that scatter; run i takes the i-th child of this seed.
    workers : int
        Threads; -1 is one a core.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> runs = Sweep(rig, [1.0, 5.0, 12.0], support_stiffness=[[2214.0], [3745.0]], settling=1.0)
    >>> runs.features()["slip_frequency"].round()
    array([[152., 640.,  nan],
           [150., 613.,  nan]])
    """

    rig: Rig | Sequence[Rig]
    speed: ArrayLike | ShaftMotion | Sequence[ShaftMotion]
    interference: ArrayLike = 0.279e-3
    support_stiffness: ArrayLike = 2214.0
    seconds: float = 1.0
    settling: float = 0.0
    rate: float = 30e3
    library: Mapping[str, Effect] = field(default_factory=lambda: EFFECTS)
    seed: int = 0
    workers: int = -1

    def features(self) -> SweptFeatures:
        """Simulate, and return features of each run.

        Returns
        -------
        SweptFeatures
            A dict of str to ndarray, of the shape as broadcast: one array for each of `FEATURES`.

        Raises
        ------
        ParameterError
            If a condition cannot be used, or shapes do not fit together.
        """
        columns = self._columns()
        rigs, speeds = columns[0].ravel(), columns[1].ravel()
        for speed in speeds:
            if isinstance(speed, float) and not np.isfinite(speed):
                raise ParameterError(f"speed = {speed:g} rad/s must be a finite number")
        features = np.empty((rigs.size, len(FEATURES)))
        rest = np.ones(rigs.size, dtype=bool)
        for rig in {id(rig): rig for rig in rigs}.values():
            if self._is_plain(rig):
                runs = [
                    i for i in range(rigs.size) if rigs[i] is rig and isinstance(speeds[i], float)
                ]
                where = [column.ravel()[runs].astype(np.float64) for column in columns[1:]]
                features[runs] = self._plain_features(rig, *where)
                rest[runs] = False
        positions = np.flatnonzero(rest).tolist()
        for i, found in zip(
            positions, self._each(columns, positions, motion_features), strict=True
        ):
            features[i] = found
        shape = columns[0].shape
        by_name = {name: features[:, i].reshape(shape) for i, name in enumerate(FEATURES)}
        return SweptFeatures(by_name, dict(zip(_CONDITIONS, columns, strict=True)))

    def torque(self, every: int = 10) -> NDArray[np.float32]:
        """Simulate, and return the torque of each run, decimated.

        Parameters
        ----------
        every : int
            One of so many samples is kept, after an anti-alias filter.

        Returns
        -------
        ndarray of float32, shape (..., ceil(seconds * rate / every))
            Torque in the elastomer, T_E [Nm]; leading axes as broadcast.

        Raises
        ------
        ParameterError
            As `features`, or if `every` is below 1.

        Examples
        --------
        >>> from models.rig_file import load_material_rig
        >>> Sweep(load_material_rig("fluorocarbon-thesis"), [1.0, 5.0], seconds=0.1).torque().shape
        (2, 300)
        """
        if every < 1:
            raise ParameterError(f"every = {every} must be 1 or more")
        quiet = Acquisition(rate=self.rate / every, noise={})

        def decimated(motion: Motion) -> NDArray[np.float32]:
            kept = sample({"torque": motion.torque}, every, quiet, np.random.default_rng(0))
            return kept["torque"].astype(np.float32)

        columns = self._columns()
        rows = self._each(columns, range(columns[0].size), decimated)
        return np.array(rows, dtype=np.float32).reshape(*columns[0].shape, -1)

    def _columns(self) -> tuple[NDArray[Any], ...]:
        """Rig, speed, interference and support stiffness of all runs, as arrays of one shape."""
        if not (self.seconds > 0.0 and self.rate > 0.0 and self.settling >= 0.0):
            raise ParameterError(
                f"seconds = {self.seconds:g} and rate = {self.rate:g} Hz must be above 0, "
                f"settling = {self.settling:g} s at least 0"
            )
        if round(self.seconds * self.rate) < 2:
            raise ParameterError(f"seconds = {self.seconds:g} s holds less than two samples")
        given = (self.rig, self.speed, self.interference, self.support_stiffness)
        try:
            return np.broadcast_arrays(*(_objects(values) for values in given))
        except ValueError as error:
            raise ParameterError(
                f"rig, speed, interference and support_stiffness do not fit together: {error}"
            ) from None

    def _samples(self) -> tuple[int, int]:
        """How many are left out at the start, and how many there are in all."""
        n_settling = round(self.settling * self.rate)
        return n_settling, n_settling + round(self.seconds * self.rate)

    def _is_plain(self, rig: Rig) -> bool:
        return friction_law(rig.friction.name).torque is None and not any(
            active.effect.drive is not None or active.effect.contact is not None
            for active in activated(rig.effects, self.library)
        )

    def _plain_features(
        self,
        rig: Rig,
        speed: NDArray[np.float64],
        interference: NDArray[np.float64],
        support_stiffness: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        step = 1.0 / self.rate
        systems = packed_systems(rig, interference, support_stiffness)
        parts = np.array([parts_of_a_step(system, step) for system in systems[:, :6]])
        whole = np.array([extended(system) for system in systems[:, :6]])
        features = np.empty((speed.size, len(FEATURES)))
        chunks = (slice(i, i + _CHUNK) for i in range(0, speed.size, _CHUNK))
        Parallel(n_jobs=self.workers, prefer="threads", batch_size=1)(
            delayed(plain_features)(
                whole[runs],
                systems[runs, 6:],
                speed[runs],
                step,
                parts[runs],
                *self._samples(),
                features[runs],
            )
            for runs in chunks
        )
        return features

    def _each(
        self,
        columns: tuple[NDArray[Any], ...],
        positions: Iterable[int],
        keep: Callable[[Motion], NDArray[np.floating]],
    ) -> list[NDArray[np.floating]]:
        n_settling, n_samples = self._samples()

        def run(position: int) -> NDArray[np.floating]:
            rig, speed, interference, support_stiffness = (c.flat[position] for c in columns)
            motion = simulate_motion(
                rig,
                ConstantSpeed(speed) if isinstance(speed, float) else speed,
                interference=interference,
                support_stiffness=support_stiffness,
                seconds=n_samples / self.rate,
                rate=self.rate,
                effects=activated(rig.effects, self.library),
                # The child that SeedSequence.spawn gives at this position.
                rng=np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=(position,))),
            )
            return keep(motion.since(n_settling))

        found: list[NDArray[np.floating]] = Parallel(n_jobs=self.workers, prefer="threads")(
            delayed(run)(position) for position in positions
        )
        return found


def _objects(values: object) -> NDArray[Any]:
    """Array of numbers, rigs or shaft motions, of which there may be one or a sequence."""
    if isinstance(values, Rig) or hasattr(values, "speed"):
        one = np.empty((), dtype=object)
        one[()] = values
        return one
    if isinstance(values, Sequence) and any(
        isinstance(v, Rig) or hasattr(v, "speed") for v in values
    ):
        several = np.empty(len(values), dtype=object)
        several[:] = values
        return several
    return np.asarray(values, dtype=np.float64).astype(object)
