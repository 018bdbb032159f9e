"""Overloads, estimated: what a channel reads for what it should, whatever the curve."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from noise.diagnosis.fit.forms.form import Form, amount_form
from noise.diagnosis.gap.signature import KINDS
from sim.effects.effect import Signals, Values

if TYPE_CHECKING:
    from noise.diagnosis.fit.forms.form import Compared


_KNOTS = 61
"""Of the curve, from the lowest to the highest reading."""

_TRIED = (0.05, 0.2, 0.5)
"""Shares cut off that a fit looks at."""

_LEAD = 0.08
_FEWEST = 5
"""Samples from which a knot is known."""


def overload_forms(compared: Sequence[Compared]) -> list[Form]:
    """Estimate the curve of acceleration and sound, over what the torque lets expect."""
    kinds = [k for k in KINDS if all(k in c.expected for c in compared)]
    curves = {
        k: np.median([_curve(c.expected[k], c.measured[k], c.rate) for c in compared], axis=0)
        for k in kinds
    }
    estimated = [_form({k: curves[k] for k in one}) for one in _sets(kinds)]
    given = [k for k in KINDS if all(k in c.measured for c in compared)]
    return estimated + [_about_mean(one, how) for one in _sets(given) for how in _HOW]


def _sets(kinds: Sequence[str]) -> list[tuple[str, ...]]:
    return [one for n in range(1, len(kinds) + 1) for one in combinations(kinds, n)]


def _form(curves: Mapping[str, NDArray[np.float64]]) -> Form:
    def sensors(
        signals: Signals, _rate: float, _form: str, values: Values, _rng: np.random.Generator
    ) -> Signals:
        read = dict(signals)
        for kind, curve in curves.items():
            away, peak = _scaled(signals[kind])
            bent = np.interp(away, np.linspace(-1.0, 1.0, _KNOTS), curve)
            read[kind] = signals[kind] + values["amount"] * peak * (bent - away)
        return read

    name = f"estimated of {' and '.join(curves)}"
    return amount_form("clipping", name, highest=2.0, sensors=sensors)


def _about_mean(kinds: tuple[str, ...], how: str) -> Form:
    """Overload about a channel's mean, as behind a capacitor; `amount` is the share cut off."""

    def sensors(
        signals: Signals, _rate: float, _form: str, values: Values, _rng: np.random.Generator
    ) -> Signals:
        read = dict(signals)
        for kind in kinds:
            away, peak = _scaled(signals[kind])
            limit = 1.0 - values["amount"]
            read[kind] = signals[kind] + peak * (_HOW[how](away, limit) - away)
        return read

    name = f"{how} about the mean of {' and '.join(kinds)}"
    return amount_form("clipping", name, highest=0.9, tried=_TRIED, sensors=sensors)


_HOW: Mapping[str, Callable[[NDArray[np.float64], float], NDArray[np.float64]]] = {
    "cut": lambda x, limit: np.clip(x, -limit, limit),
    "wrapped": lambda x, limit: (x + limit) % (2.0 * limit) - limit,
    "folded": lambda x, limit: np.clip(x, -limit, limit) - (x - np.clip(x, -limit, limit)),
}
"""What an overload makes of a signal of peak 1."""


def _scaled(x: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
    away = x - x.mean()
    peak = float(np.abs(away).max()) or 1.0
    return np.asarray(away / peak), peak


def _curve(
    expected: NDArray[np.float64], measured: NDArray[np.float64], rate: float
) -> NDArray[np.float64]:
    cut = round(_LEAD * rate)
    x, peak = _scaled(expected[cut:])
    y = (measured[cut:] - measured[cut:].mean()) / peak
    knots = np.linspace(-1.0, 1.0, _KNOTS)
    place = np.clip(((x + 1.0) * 0.5 * (_KNOTS - 1)).round().astype(int), 0, _KNOTS - 1)
    count = np.bincount(place, minlength=_KNOTS)
    total = np.bincount(place, y, minlength=_KNOTS)
    known = count >= _FEWEST
    return np.interp(knots, knots[known], total[known] / count[known])
