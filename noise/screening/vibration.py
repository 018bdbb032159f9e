"""Vibration at one condition: whether it dies, persists once started, or breaks out from rest.

Stable sliding and a limit cycle may coexist: where the instability of sliding is subcritical, a
vibration that already runs goes on at speeds at which none begins (A. Papangelo, M. Ciavarella,
N. Hoffmann, *Subcritical bifurcation in a self-excited single-degree-of-freedom system with
velocity weakening-strengthening friction law*, Nonlinear Dynamics 90, 2017). So a condition is run
from rest and from a running vibration. The latter is a continuation: the rig runs where its sliding
is unstable, at the nearest such speed, and the shaft is then brought to the speed in question,
slowly enough for the limit cycle to follow; a jump often loses it.

The eigenvalue of steady sliding (`sim.analysis.stability`) says which runs are needed. Where it
grows, no vibration dies. Where it falls, a run that starts vibrating and dies settles the matter.
A run ends when growth or decay of the torque's oscillation, measured over blocks, makes its end
certain, and after `LONGEST` at most. An irregular vibration beside stable sliding may be a
transient that ends suddenly after seconds, which no decay announces; it is followed for longer.
What dies is started once more from a speed at which it is large.

Speeds of one row are asked together: from where sliding is unstable outwards a vibration persists
up to some speed and dies beyond, which is bisected, and runs go on from each other.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.signal import detrend

from models.rig import Rig
from noise.base.labels import PERSISTS
from sim.analysis.regime import LEAST_OSCILLATION
from sim.analysis.stability import sliding_growth
from sim.effects import EFFECTS
from sim.effects.effect import activated
from sim.motion import Motion, MotionSolver, lookahead_samples
from sim.temperature import at_temperature

BREAKS_OUT = "breaks out"
"""State of a condition at which vibration begins from rest."""

RATE = 30e3
"""Of motion and sound [Hz]; creaks reach 15 kHz."""

LONGEST = 20.0
"""A run lasts no longer [s]."""

BLOCK = 0.2
"""Of which an oscillation is measured [s]."""

_TOLERANCE = 1e-5
_FOLLOWED = 3
"""Blocks over which growth or decay is measured."""

_NEAREST = (0.4, 1.0)
"""How long a rig runs at the nearest speed at which sliding is unstable, and in which time the
speed is then changed [s]."""

_LARGE = (0.5, 1.0, 0.5)
"""A share of the speed at which a vibration is large, and the same times [s]: what is small at the
nearest unstable speed, or takes a second to grow, may die on the way from there."""

_RAMP, _LEAST_RAMP = 5.0, 0.2
"""In which time the speed is brought from that of a vibration to the next, over their relative
distance, and at least [s]."""

_AROUND = np.concatenate([np.arange(0.22, 1.0, 0.04), np.arange(1.04, 1.6, 0.06)])
"""Shares of a speed among which unstable ones are sought [-]."""

_STARTS = (
    (0.97, 0.4, 0.0), (0.85, 0.4, 0.0), (0.7, 0.4, 0.0), (0.5, 0.4, 0.0), (0.25, 0.4, 0.0),
    (0.75, 0.4, 0.6), (0.5, 0.4, 0.6),
)  # fmt: skip
"""Shares of the speed at which a contact is brought to stick and slip that slides stably at any,
and the same times [s]."""

_JUMPS = ((0.97, 0.4, 0.05), (0.85, 0.4, 0.05), (0.7, 1.0, 0.5))
"""The same for starts at the first speed at which a vibration dies. Several vibrations may exist
beside stable sliding, and one that no slow change of speed reaches can be reached by a jump."""

_DAMPED = -100.0
"""Growth below which a vibration that dies is not started again [1/s]; those that lasted beside
stable sliding in 400 drawn designs are at -45 and above."""

_SURE = 10.0
"""Growth from which on sliding soon vibrates [1/s]."""

_HORIZON = 20.0
"""A vibration lasts if at its decay it would be there after that time [s]."""

_STEADY = 1.02
"""Ratio of a vibration's size to an earlier one, below which it does not grow [-]."""

_REGULAR = 0.003
"""Relative scatter of a vibration's size over blocks, up to which it repeats itself [-]."""

_IRREGULAR = 5.0
"""How long one that does not is followed beside stable sliding [s]."""

_LAST_BLOCKS = 10
"""Blocks of a motion that are kept."""

_DEAD = 0.1
"""Share of the least oscillation below which a vibration in stable sliding is over [-]."""


@dataclass(frozen=True)
class Condition:
    """One condition of a map, in SI units.

    Parameters
    ----------
    speed : float
        Of the shaft [rad/s]; where it swings the largest.
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]; ``math.inf`` for the clamp bolted to the baseplate.
    temperature : float
        [degree Celsius]
    frequency : float, optional
        Of the swing [Hz]; None where the shaft turns at constant speed.
    """

    speed: float
    interference: float
    support_stiffness: float
    temperature: float = 23.0
    frequency: float | None = None


@dataclass(frozen=True, eq=False)
class Course:
    """Course of a vibration.

    Parameters
    ----------
    lasts : bool
        Whether it is still there, and neither dies nor is about to.
    motion : Motion
        The last two seconds.
    solver : MotionSolver
        From which the run goes on.
    speed : float
        Of the shaft [rad/s].
    """

    lasts: bool
    motion: Motion
    solver: MotionSolver
    speed: float


@dataclass(frozen=True, eq=False)
class Vibration:
    """Outcome of the vibration at a condition.

    Parameters
    ----------
    state : str
        ``none`` where a running vibration dies, ``persists`` where it goes on but none breaks out
        from rest, ``breaks out`` elsewhere.
    course : Course, optional
        Of the vibration; None where there is none.
    simulated : bool
        False beyond a speed at which the vibration has died, where nothing is run.
    """

    state: str
    course: Course | None
    simulated: bool = True


def vibration_at(rig: Rig, at: Condition, *, from_rest: bool = False) -> Vibration:
    """Return the outcome of a vibration at a condition of constant speed.

    Parameters
    ----------
    rig : Rig
    at : Condition
    from_rest : bool
        Whether to run from rest as well where a vibration that runs dies, which is harder to kill.

    Returns
    -------
    Vibration

    Raises
    ------
    ParameterError
        If a value cannot be used.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rig = load_material_rig("fluorocarbon")
    >>> states = [vibration_at(rig, Condition(v, 0.279e-3, 2214.0)).state for v in (5.0, 13.0)]
    >>> states
    ['breaks out', 'none']
    """
    [(_, vibration)] = vibrations_at(rig, [at], from_rest=from_rest)
    return vibration


def vibrations_at(
    rig: Rig, row: Sequence[Condition], *, from_rest: bool = False
) -> Iterator[tuple[int, Vibration]]:
    """Yield the outcomes of vibrations at conditions that differ in speed alone, in any order.

    From where sliding is unstable outwards a vibration persists up to some speed and dies beyond,
    so that speed is bisected; each run goes on from the nearest that lasts.

    Parameters
    ----------
    rig : Rig
    row : sequence of Condition
    from_rest : bool
        As for `vibration_at`.

    Yields
    ------
    (int, Vibration)
        Index of the condition, and the outcome there.
    """
    speed = np.array([at.speed for at in row])
    around = np.concatenate([speed[:, None], speed[:, None] * _AROUND], axis=1)
    growth = growth_at(rig, row[0], around)
    unstable = [_nearest_unstable(v, each) for v, each in zip(speed, growth[:, 1:], strict=True)]
    own = growth[:, 0].tolist()
    sides: dict[tuple[bool, int], list[int]] = {}
    for i in np.argsort(speed).tolist():
        if own[i] > 0.0:
            yield i, _unstable(rig, row[i], own[i], unstable[i])
        elif (start := unstable[i]) is None:
            course = running(rig, row[i], own[i])
            # A contact stuck at rest may vibrate though no speed makes its sliding unstable.
            yield i, _beside_rest(rig, row[i], own[i], course, from_rest=True)
        else:
            between = int(np.sum((speed < speed[i]) & (growth[:, 0] > 0.0)))
            sides.setdefault((start > speed[i], between), []).append(i)
    for (above, _), side in sides.items():
        side = side[::-1] if above else side
        reached = _outwards(rig, [(row[i], own[i], unstable[i]) for i in side])
        for i, (known, ran) in zip(side, reached, strict=True):
            vibration = _beside_rest(rig, row[i], own[i], known, from_rest=from_rest)
            yield i, replace(vibration, simulated=ran or from_rest)


def _unstable(rig: Rig, at: Condition, growth: float, start: float | None) -> Vibration:
    """Return the outcome of a vibration where steady sliding is unstable."""
    course = _followed(_solver(rig, at), at, growth)
    if not course.lasts:  # it grows so slowly that only what runs already shows where it ends
        course = running(rig, at, growth, start)
    if course.lasts:
        return Vibration(BREAKS_OUT, course)
    return Vibration("none", None)


def _beside_rest(
    rig: Rig, at: Condition, growth: float, course: Course | None, *, from_rest: bool
) -> Vibration:
    """Return the outcome where sliding is stable, from a running vibration or from none."""
    lasts = course is not None and course.lasts
    if lasts or from_rest:
        rested = _followed(_solver(rig, at), at, growth)
        if rested.lasts:
            return Vibration(BREAKS_OUT, rested)
    if lasts:
        return Vibration(PERSISTS, course)
    return Vibration("none", None)


def _outwards(
    rig: Rig, side: list[tuple[Condition, float, float | None]]
) -> Iterator[tuple[Course | None, bool]]:
    """Yield courses outwards from where sliding is unstable, and whether they were run.

    Where they have died before there is none, and most such speeds are not run.
    """
    ran: set[int] = set()
    jumped: set[int] = set()
    lasting: dict[int, Course] = {}
    dead: dict[int, int] = {}  # by where the vibration came from
    last, first_dead = -1, len(side)
    while True:
        if first_dead - last > 1 or dead.get(first_dead, last) != last:
            k = (last + first_dead) // 2 if first_dead - last > 1 else first_dead
            at, growth, start = side[k]
            ran.add(k)
            course = running(rig, at, growth, start, started=lasting.get(last), again=k == 0)
        else:
            k = first_dead
            if k in jumped or k == len(side) or side[k][1] < _DAMPED:
                break
            jumped.add(k)
            course = _started(rig, *side[k][:2], _JUMPS)
        if course.lasts:
            lasting[k], last = course, k
            dead.pop(k, None)
        else:
            dead[k] = last
        first_dead = min((one for one in dead if one > last), default=len(side))
    for k, (at, growth, start) in enumerate(side):
        if k > last:
            yield None, k in ran
        elif k in lasting:
            yield lasting[k], True
        else:
            near = lasting[min(lasting, key=lambda one: abs(one - k))]
            course = running(rig, at, growth, start, started=near, patience=0.0)
            yield course if course.lasts else running(rig, at, growth, start), True


def growth_at(rig: Rig, at: Condition, speed: ArrayLike | None = None) -> NDArray[np.float64]:
    """Return the growth rate of a small vibration about steady sliding [1/s].

    Parameters
    ----------
    rig : Rig
    at : Condition
    speed : array_like, shape (...), optional
        In place of that of `at` [rad/s].

    Returns
    -------
    ndarray, shape (...)
        [1/s]
    """
    rig = at_temperature(rig, at.temperature)
    speed = at.speed if speed is None else speed
    return sliding_growth(rig, speed, at.interference, at.support_stiffness)


def running(
    rig: Rig,
    at: Condition,
    growth: float,
    unstable: float | None = None,
    *,
    started: Course | None = None,
    again: bool = True,
    patience: float = _IRREGULAR,
) -> Course:
    """Simulate a vibration that already runs when a condition is reached.

    Parameters
    ----------
    rig : Rig
    at : Condition
    growth : float
        Of a small vibration there [1/s].
    unstable : float, optional
        Nearest speed at which sliding is unstable, where the rig runs before [rad/s].
    started : Course, optional
        Vibration at another speed or of another rig, which goes on instead.
    again : bool
        Whether what dies is started once more, where it is large.
    patience : float
        How long one that is irregular is followed beside stable sliding [s].

    Returns
    -------
    Course
    """
    if started is not None:
        solver = _solver(rig, at)
        solver.continue_from(started.solver, started.speed)
        apart = abs(at.speed - started.speed) / at.speed
        seconds = max(_LEAST_RAMP, _RAMP * apart) if apart else 0.0
        ramp = np.linspace(started.speed, at.speed, round(seconds * RATE))
        return _followed(solver, at, growth, approach=ramp, patience=patience)
    if unstable is None:
        return _started(rig, at, growth, _STARTS, patience)
    starts = ((unstable / at.speed, *_NEAREST), _LARGE)
    return _started(rig, at, growth, starts[: 2 if again and growth >= _DAMPED else 1], patience)


def _started(
    rig: Rig,
    at: Condition,
    growth: float,
    starts: Sequence[tuple[float, float, float]],
    patience: float = _IRREGULAR,
) -> Course:
    """Return the first course that lasts of several starts; the last one if none does.

    A start is a share of the speed [-], how long the rig runs there, and in which time the speed is
    then changed [s].
    """
    for share, held, seconds in starts:
        start = share * at.speed
        solver = _solver(rig, replace(at, speed=start))
        ramp = np.linspace(start, at.speed, round(seconds * RATE))
        approach = np.concatenate([np.full(round(held * RATE), start), ramp])
        course = _followed(solver, at, growth, approach=approach, held=held, patience=patience)
        if course.lasts:
            break
    return course


def _nearest_unstable(speed: float, growth: NDArray[np.float64]) -> float | None:
    """Return the nearest speed at which sliding is unstable [rad/s], clearly so if there is one."""
    near = np.flatnonzero(growth > _SURE)
    if near.size:
        return float(speed * _AROUND[near[np.argmin(np.abs(_AROUND[near] - 1.0))]])
    return float(speed * _AROUND[growth.argmax()]) if growth.max() > 0.0 else None


def _solver(rig: Rig, at: Condition) -> MotionSolver:
    rig = at_temperature(rig, at.temperature)
    return MotionSolver(
        rig, at.interference, at.support_stiffness, RATE, activated(rig.effects, EFFECTS),
        np.random.default_rng(0), start_speed=at.speed, tolerance=_TOLERANCE,
    )  # fmt: skip


def _followed(
    solver: MotionSolver,
    at: Condition,
    growth: float,
    *,
    approach: NDArray[np.float64] | None = None,
    held: float = 0.0,
    patience: float = _IRREGULAR,
) -> Course:
    """Simulate in blocks until it is certain whether the vibration dies or lasts.

    The speeds of `approach` [rad/s] come first; a vibration that dies in them after `held` [s] is
    over.
    """
    n = round(BLOCK * RATE)
    before = np.empty(0) if approach is None else approach
    first, last = before.size // n, before.size // n + round(LONGEST / BLOCK)
    drive = np.concatenate(
        [before, np.full((last - first) * n + lookahead_samples(RATE), at.speed)]
    )
    parts: deque[Motion] = deque(maxlen=_LAST_BLOCKS)
    sizes: list[float] = []
    certain = None
    for block in range(last):
        ahead = drive[block * n : (block + 1) * n + lookahead_samples(RATE)]
        parts.append(solver.advance(ahead, n))
        torque = parts[-1].torque
        if block >= first:
            sizes.append(oscillation(torque))
            certain = _outcome(np.array(sizes), growth, patience)
        elif block * BLOCK >= held and growth <= 0.0:
            # Without the trend that the torque has with the speed.
            late = torque[-torque.size // 4 :]
            certain = False if oscillation(detrend(late) + np.mean(late)) < _DEAD else None
        if certain is not None:
            break
    # Where sliding is unstable it may rise and fall in bursts, seconds apart.
    last_sizes = sizes[-round(_IRREGULAR / BLOCK) :] if growth > 0.0 else sizes[-1:]
    lasts = max(last_sizes) > 1.0 if certain is None else certain
    return Course(lasts, parts[0].followed_by(*list(parts)[1:]), solver, at.speed)


def _outcome(sizes: NDArray[np.float64], growth: float, patience: float) -> bool | None:
    """Return whether a vibration lasts, by the size of its blocks; None where that is open."""
    if growth <= 0.0 and sizes[-1] < _DEAD:
        return False
    if sizes.size < 2 * _FOLLOWED:
        return None
    half = sizes.size // 2
    early, late = np.median(sizes[half - half // 2 - 1 : half]), np.median(sizes[-half // 2 :])
    lately = sizes[-2 * _FOLLOWED :]
    irregular = np.std(lately) > _REGULAR * np.mean(lately)
    if late <= 1.0:  # too weak to count, unless it grows, or grows again
        return False if growth > 0.0 and late < _STEADY * early and not irregular else None
    if growth <= 0.0 and irregular and sizes.size * BLOCK < patience:
        return None
    seconds = 0.75 * half * BLOCK
    return True if late - 1.0 > (early - late) / seconds * _HORIZON else None


def gone_on(course: Course, seconds: float) -> Motion:
    """Return the motion of a course that goes on at its speed for `seconds` [s]."""
    n = round(seconds * RATE)
    drive = np.full(n + lookahead_samples(RATE), course.speed)
    return course.motion.followed_by(course.solver.advance(drive, n))


def oscillation(torque: NDArray[np.float64]) -> float:
    """Return the standard deviation of a torque over its mean, re an oscillation's least.

    Parameters
    ----------
    torque : ndarray, shape (n,)
        [Nm]

    Returns
    -------
    float
        [-]
    """
    mean = abs(float(np.mean(torque)))
    return float(np.std(torque)) / (LEAST_OSCILLATION * mean) if mean > 0.0 else math.inf
