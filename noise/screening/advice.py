"""Advice: changes of one parameter that end a noise, verified by simulation.

Of each parameter the changes that a drawing can carry, whole steps of 5 and 10 %, are tried
outwards from the design, as far as a rig file accepts them. A change ends the noise if the
vibration dies with it from rest, from the noise that is running as the change sets in, and from the
changed rig's own nearest noise (`noise.screening.vibration`). It is offered if that also holds of a
change smaller by `MARGIN` and of the next larger one, so that no offer stands on an edge. Where no
step of a parameter does it, the advice says so, and from which on it is quiet from rest only: a
vibration that already runs goes on. One parameter is changed at a time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from joblib import Parallel, delayed

from models.errors import ParameterError
from models.rig import Rig
from noise.base.labels import PERSISTS
from noise.batch.work import one_thread
from noise.screening.design import PARAMETERS
from noise.screening.environments import FIT_PARAMETERS
from noise.screening.parts import nominal_values
from noise.screening.vibration import (
    BREAKS_OUT,
    Condition,
    Course,
    growth_at,
    running,
    vibration_at,
)

STEPS = (5, 10, 15, 20, 25, 30, 40, 50, 60, 70, 80, 90, 100, 120, 150, 200)
"""Simulated changes, upwards and, to a half, downwards [%]."""

MOST_DOWN = 50
"""[%]"""

MARGIN = 2
"""Part of an offered change without which it still ends the noise [%]."""


@dataclass(frozen=True)
class Offer:
    """Effect of changing one parameter in one direction on a noise.

    Parameters
    ----------
    name : str
        Of `noise.screening.design.PARAMETERS`.
    nominal : float
        Value as it is, in the unit of `PARAMETERS`, such as [Nm].
    percent : int
        Change that ends the noise, or the largest simulated one where none does [%].
    ends : bool
        Whether it ends the noise, from rest and from running noise.
    limit : str
        Reason why no larger change was simulated; empty where the steps end.
    from_rest : int, optional
        Smallest change after which none breaks out from rest, but a running one goes on [%]; None
        where there is none.
    quiet_elsewhere, elsewhere : int
        Number of other noisy conditions at which the same change ends the noise, and number that
        were simulated.
    left : Condition, optional
        The first of these at which it does not; None where it ends the noise at all.
    """

    name: str
    nominal: float
    percent: int
    ends: bool
    limit: str = ""
    from_rest: int | None = None
    quiet_elsewhere: int = 0
    elsewhere: int = 0
    left: Condition | None = None

    @property
    def value(self) -> float:
        """After the change, in the unit of the nominal value, such as [Nm]."""
        return self.nominal * (1.0 + self.percent / 100.0)

    @property
    def words(self) -> str:
        """The change, as a drawing has it.

        Examples
        --------
        >>> Offer("critical_torque", 10.7, -20, True).words
        'critical torque -20 % to 8.56 Nm'
        """
        return f"{self.short} to {self.value:.4g} {PARAMETERS[self.name]}"

    @property
    def short(self) -> str:
        """The change without the new value."""
        return f"{self.name.replace('_', ' ')} {self.percent:+d} %"


def changed(rig: Rig, at: Condition, name: str, percent: float) -> tuple[Rig, Condition]:
    """Return rig and condition with one parameter changed, as a rig file does it.

    Parameters
    ----------
    rig : Rig
    at : Condition
    name : str
        A parameter of the fits, ``interference`` or ``support_stiffness``.
    percent : float
        [%]

    Raises
    ------
    ParameterError
        A rig file with this change is refused, or the rig has no data for it.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rig, at = load_material_rig("fluorocarbon-thesis"), Condition(5.0, 0.279e-3, 2214.0)
    >>> round(changed(rig, at, "critical_torque", -10)[0].fit(0.279e-3).critical_torque, 2)
    9.63
    >>> changed(rig, at, "critical_torque", -30)
    Traceback (most recent call last):
    models.errors.ParameterError: ...
    """
    if name in FIT_PARAMETERS:
        try:
            return rig.changed(**{name: f"{percent:+g} %"}), at
        except ParameterError as error:
            reason = str(error).removeprefix(f"rig {rig.name!r}: ")
            raise ParameterError(f"a rig file changes all of its fits; {reason}") from None
    value = getattr(at, name) * (1.0 + percent / 100.0)
    if name == "interference":
        low, high = rig.interference_range
        if not low <= value <= high:
            raise ParameterError(
                f"fits are given from {1e3 * low:g} to {1e3 * high:g} mm, not for {1e3 * value:.3g}"
            )
    return rig, replace(at, **{name: value})


def advise(
    rig: Rig, at: Condition, elsewhere: Sequence[Condition] = (), *, workers: int = -1
) -> tuple[Offer, ...]:
    """Return the changes that end the noise at a condition, and those that do not.

    Parameters
    ----------
    rig : Rig
    at : Condition
        Of constant speed, at which it is noisy.
    elsewhere : sequence of Condition
        Other noisy conditions, at which the offers that end the noise are simulated as well.
    workers : int
        Threads; -1 is one a core.

    Returns
    -------
    tuple of Offer
        Those that end the noise first, of these the quietest elsewhere and then the smallest
        change; of each parameter and way one. None where nothing vibrates.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> advise(load_material_rig("PDMS"), Condition(5.0, 0.279e-3, 2214.0))
    ()
    """
    noise = vibration_at(rig, at).course
    if noise is None:
        return ()
    names = [*FIT_PARAMETERS, "support_stiffness", "interference"]
    if math.isinf(at.support_stiffness):
        names.remove("support_stiffness")
    with one_thread():
        work = Parallel(n_jobs=workers, prefer="threads")
        offers: list[Offer] = work(
            delayed(_offer)(rig, at, noise, name, way) for name in names for way in (-1, 1)
        )
        trials = [(other, offer) for offer in offers if offer.ends for other in elsewhere]
        quiet = iter(work(delayed(_ends_at)(rig, *trial) for trial in trials))
    for i, offer in enumerate(offers):
        if offer.ends:
            left = [other for other in elsewhere if not next(quiet)]
            offers[i] = replace(
                offer,
                quiet_elsewhere=len(elsewhere) - len(left),
                elsewhere=len(elsewhere),
                left=left[0] if left else None,
            )

    def order(offer: Offer) -> tuple[bool, int, int]:
        return not offer.ends, -offer.quiet_elsewhere, abs(offer.percent)

    return tuple(sorted(offers, key=order))


def _offer(rig: Rig, at: Condition, noise: Course, name: str, way: int) -> Offer:
    """Return the smallest change in one direction that ends the noise with a margin."""
    steps: list[int] = []
    limit, known = "", dict[int, str]()
    for step in STEPS:
        if way * step < -MOST_DOWN:
            break
        try:
            changed(rig, at, name, way * step)
        except ParameterError as error:
            limit = str(error)
            break
        steps.append(way * step)

    def ends(percent: int) -> bool:
        if percent not in known:
            known[percent] = _state(*changed(rig, at, name, percent), noise)
        return known[percent] == "none"

    ending = next(
        (
            percent
            for percent, beyond in zip(steps, steps[1:] + steps[-1:], strict=True)
            if ends(percent) and ends(percent - way * MARGIN) and ends(beyond)
        ),
        None,
    )
    return Offer(
        name,
        nominal_values(rig, at)[name],
        ending or max(steps, key=abs, default=0),
        ends=ending is not None,
        limit="" if ending else limit,
        from_rest=next((one for one in steps if known.get(one) == PERSISTS), None),
    )


def _state(rig: Rig, at: Condition, noise: Course | None = None) -> str:
    """Return the state of a vibration from every start, also from that of another rig."""
    growth = float(growth_at(rig, at))
    if growth > 0.0:  # which the least disturbance follows
        return BREAKS_OUT
    state = vibration_at(rig, at, from_rest=True).state
    if state == "none" and noise is not None:
        goes_on = running(rig, at, growth, started=noise).lasts
        return PERSISTS if goes_on else state
    return state


def _ends_at(rig: Rig, at: Condition, offer: Offer) -> bool:
    """Return whether an offer ends the noise at another condition."""
    noise = vibration_at(rig, at).course
    try:
        there = changed(rig, at, offer.name, offer.percent)
        return _state(*there, noise) == "none"
    except ParameterError:
        return False
