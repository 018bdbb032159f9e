"""Words for terminal, tables and pages: is it quiet in its use, where not, what helps, how sure.

Each question has one function here, and every output takes its sentences from them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from noise.base.labels import PERSISTS
from noise.screening.advice import Offer
from noise.screening.axis_values import axis_words
from noise.screening.mapping import DesignMap
from noise.screening.parts import Robustness
from noise.screening.vibration import Condition

if TYPE_CHECKING:
    from noise.screening.standing import Standing

RANKING_RULE = (
    "ranked by mean loudness, the mean over the conditions of use of what is heard there or would "
    "go on once started: 1 sone is 40 dB(A), 10 dB more is twice as much, silence is 0"
)
"""What the ranking goes by."""

_DENSE = 0.7
"""Share of the points between the slowest and the fastest that a noise fills where it is told to
reach from the one to the other."""

_VERBS = {
    "creak": "creaks", "squawk": "squawks", "squeal": "squeals",
    PERSISTS: "is quiet from rest, but vibration persists once started,",
}  # fmt: skip


def use_words(found: DesignMap, never_slips: str = "") -> str:
    """Say whether a design is quiet over its use, and where it is not.

    Parameters
    ----------
    found : DesignMap
    never_slips : str
        Why the contact never slips; empty where it does.

    Examples
    --------
    >>> from noise.screening.design import Use
    >>> from noise.screening.screen import screen
    >>> use = Use(speed=(2.0, 12.0), interference=(0.279e-3,), support_stiffness=(2214.0,))
    >>> screen(["PDMS"], use).standings[0].words
    'quiet in its use, all 2 conditions'
    """
    if never_slips:
        return f"{never_slips}; quiet" if found.grid.frequency else never_slips
    used = found.grid.used
    speed, label = np.array(found.grid.speed)[used], found.label[..., used]
    shares = {name: float(np.mean(label == name)) for name in _VERBS}
    heard = sorted((name for name in shares if shares[name]), key=lambda name: -shares[name])
    if not heard:
        return f"quiet in its use, all {label.size} conditions"
    noisy = sum(share for name, share in shares.items() if name != PERSISTS)
    head = f"noisy at {percent(noisy)} of its use" if noisy else "quiet from rest in its use"
    told = [_noise(name, label == name, speed, found) for name in heard]
    return f"{head}: {'; '.join(told)}"


def percent(share: float) -> str:
    """Write a share.

    Examples
    --------
    >>> percent(0.5), percent(0.001)
    ('50%', '< 1%')
    """
    return "< 1%" if 0.0 < share < 0.005 else f"{share:.0%}"


def _noise(
    name: str, happens: NDArray[np.bool_], speed: NDArray[np.float64], found: DesignMap
) -> str:
    """Say from which speed to which a noise is and where, or how often."""
    columns = np.flatnonzero(happens.any(axis=(0, 1, 2)))
    inside = slice(columns[0], columns[-1] + 1)
    lines = np.asarray(happens[..., inside].any(axis=3))
    dense = float(happens[..., inside][lines].mean()) >= _DENSE
    often = [] if dense else [f"at {percent(float(happens.mean()))} of the use,"]
    return " ".join([_VERBS[name], *often, _between(speed[inside]), *_where(lines, found)])


def _between(span: NDArray[np.float64]) -> str:
    if span.size == 1:
        return f"at {span[0]:.3g} rad/s"
    return f"from {span[0]:.3g} to {span[-1]:.3g} rad/s"


def _where(lines: NDArray[np.bool_], found: DesignMap) -> list[str]:
    """Name fits, supports and temperatures, where they are not all."""
    grid = found.grid
    temperatures, supports, fits = (np.unique(axis) for axis in np.nonzero(lines))
    return [
        say([values[i] for i in there])
        for values, there, say in (
            (grid.interference, fits, fit_words),
            (grid.support_stiffness, supports, supports_words),
            (grid.temperature, temperatures, lambda values: f"at {axis_words(values)} °C"),
        )
        if there.size < len(values)
    ]


def fit_words(values: Sequence[float]) -> str:
    """Name interferences [m] behind what happens at them.

    Examples
    --------
    >>> fit_words([0.279e-3, 0.381e-3])
    'at 0.279 and 0.381 mm'
    """
    return f"at {axis_words([1e3 * value for value in values])} mm"


def supports_words(values: Sequence[float]) -> str:
    """Name supports [Nm/rad] behind what happens with them.

    Examples
    --------
    >>> supports_words([2214.0, math.inf])
    'on a support of 2214 Nm/rad and with the clamp fixed'
    """
    finite = [value for value in values if math.isfinite(value)]
    several = "supports" if len(finite) > 1 else "a support"
    said = [f"on {several} of {axis_words(finite)} Nm/rad"] if finite else []
    return " and ".join([*said, *(["with the clamp fixed"] if len(finite) < len(values) else [])])


def condition_words(at: Condition) -> str:
    """Name a condition.

    Examples
    --------
    >>> condition_words(Condition(5.0, 0.279e-3, math.inf))
    '5 rad/s, 0.279 mm, the clamp fixed'
    """
    support = "the clamp fixed"
    if math.isfinite(at.support_stiffness):
        support = f"{at.support_stiffness:.4g} Nm/rad"
    return f"{at.speed:.3g} rad/s, {1e3 * at.interference:.3g} mm, {support}"


def margin_words(one: Standing, use: tuple[float, float]) -> str:
    """Say up to which speed it vibrates, and how far its use is from that; none of a swing.

    Parameters
    ----------
    one : Standing
    use : (float, float)
        Slowest and fastest speed of use [rad/s].

    Examples
    --------
    >>> from noise.screening.design import Use
    >>> from noise.screening.screen import screen
    >>> found = screen(["PDMS"], Use(speed=(1.0, 5.0), support_stiffness=(2214.0,)))
    >>> margin_words(found.standings[0], (1.0, 5.0))
    'nothing vibrates at any speed of the map'
    """
    margin, last = one.margin_v_crit2, one.v_crit2
    if math.isnan(margin):
        return ""
    if margin == math.inf:
        return "nothing vibrates at any speed of the map"
    ends = f"between {last:.3g} and {one.v_crit2_high:.3g} rad/s (V_crit2)"
    if math.isinf(last):
        ends = "above the fastest speed of the map (V_crit2)"
    said = f"the last vibration ends {ends}"
    if margin > 0.0:
        return f"{said}; every speed of use is at least {margin:.3g} rad/s from what vibrates"
    if margin == 0.0:
        return f"{said}, where the use begins"
    if -margin >= use[1] - use[0]:
        return f"{said}; at worst all speeds of use vibrate"
    return f"{said}; at worst {-margin:.3g} rad/s of the speeds of use vibrate"


def advice_words(noise: str, at: Condition, offers: Sequence[Offer], most: int = 3) -> str:
    """Say which changes silence the loudest point, and what they do at other noisy ones.

    Parameters
    ----------
    noise : str
        What is heard at the loudest point.
    at : Condition
        Which that is.
    offers : sequence of Offer
        Of `noise.screening.advice.advise`.
    most : int
        That are named.

    Examples
    --------
    >>> at = Condition(5.0, 0.279e-3, 2214.0)
    >>> offers = [
    ...     Offer("critical_torque", 10.7, -20, True, quiet_elsewhere=2, elsewhere=6),
    ...     Offer("damping", 0.1, 100, False),
    ... ]
    >>> advice_words("squawk", at, offers)
    'the loudest point (squawk at 5 rad/s, 0.279 mm, 2214 Nm/rad) falls silent by critical torque...
    """
    where = f"the loudest point ({noise} at {condition_words(at)})"
    ending = [one for one in offers if one.ends]
    if not ending:
        return f"no change of one parameter silences {where}" if offers else ""
    said = [one.words + _elsewhere(one) for one in ending[:most]]
    by = "by" if len(ending) == 1 else "by any one of"
    more = len(ending) - len(said)
    return f"{where} falls silent {by} {', or '.join(said)}" + (
        f"; advice.csv has {more} more" if more else ""
    )


def _elsewhere(offer: Offer) -> str:
    """Say what an offer does at the other noisy points that were tried."""
    quiet, tried = offer.quiet_elsewhere, offer.elsewhere
    if not tried:
        return ""
    if quiet == tried:
        return f" (all {tried} other noisy points that were tried too)"
    if not quiet:
        return f" (the {tried} other noisy points that were tried stay noisy)"
    return (
        f" ({quiet} of the {tried} other noisy points that were tried too, {tried - quiet} "
        f"stay{'s' if tried - quiet == 1 else ''} noisy)"
    )


def limit_words(offers: Sequence[Offer], noise: str, most: int = 2) -> list[str]:
    """Say of changes that do not end the noise how far they go, and what they do.

    Parameters
    ----------
    offers : sequence of Offer
    noise : str
        Its name.
    most : int
        Of those that reach a limit, that are named.

    Examples
    --------
    >>> limit_words([Offer("damping", 0.1, 200, False, from_rest=150)], "squawk")
    ['damping +150 % to 0.25 Nm s/rad is quiet from rest only: the squawk persists once started']
    >>> limit_words([Offer("critical_torque", 10.0, -20, False, "too small")], "squawk")
    ['critical torque -20 % to 8 Nm reaches the limit, and the squawk goes on (too small)']
    """
    end = {one.name for one in offers if one.ends}  # in the other direction
    said = [
        f"{replace(one, percent=one.from_rest).words} is quiet from rest only: the {noise} "
        f"persists once started{f' ({one.limit})' if one.limit else ''}"
        for one in offers
        if one.from_rest is not None and not one.ends
    ]
    limited = [one for one in offers if one.limit and one.from_rest is None and one.name not in end]
    for one in limited[:most]:
        name = one.name.replace("_", " ")
        said.append(
            f"{one.words} reaches the limit, and the {noise} goes on ({one.limit})"
            if one.percent
            else f"{name} alone does not end it ({one.limit})"
        )
    if len(limited) > most:
        said.append(f"advice.csv has {len(limited) - most} more that reach a limit")
    return said


def parts_words(found: Robustness) -> list[str]:
    """Say how probably a part is noisy, and which tolerance matters most."""
    noisy = found.noisy
    assumed = " within assumed tolerances" if found.assumed else " within its tolerances"
    said = [
        f"a part{assumed} is noisy somewhere in its use with a probability of {noisy.value:.0%} "
        f"({noisy.low:.0%} to {noisy.high:.0%})"
    ]
    if found.sensitivities and found.sensitivities[0].total.value > 0.0:
        most = found.sensitivities[0]
        share = min(1.0, most.total.value)
        said.append(
            f"the tolerance of {most.name.replace('_', ' ')} matters most: {share:.0%} of the "
            "scatter of the vibration's growth"
        )
    return said
