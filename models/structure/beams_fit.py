"""Fit of anchors and clamp to natural frequencies that were measured.

Rigid anchors, assumption (5) of 3.1.1, put the first bending modes 22 and 42 % above 900 and
1375 Hz. Here three numbers that the thesis does not give are fitted, the clamp's inertia and the
stiffness of an anchor against slope and against deflection; all dimensions that it gives are kept.
The largest error matters, so the fourth power of the errors is summed. The first frequency of each
length must be the first mode in which the clamp turns, a further one is held against the nearest
mode of either motion, as nothing is known of its shape.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import minimize

from models.errors import ParameterError
from models.short_repr import short_repr
from models.structure.beams_exact import natural_frequencies
from models.structure.beams_waves import ClampOnBeams, RootMotion

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

__all__ = ["AnchorFit", "fit_anchors"]

_POWER = 4
"""Of the relative errors that are summed."""

_HEADROOM = 1.3
"""Modes are looked for up to so many times the highest measured frequency."""

_BOUNDS = {
    "clamp_inertia": (1e-4, 3e-3),
    "anchor_rotation": (10.0, 1e5),
    "anchor_translation": (1e5, 1e9),
}
"""[kg m2], [Nm/rad], [N/m]"""

_START = {"clamp_inertia": 5e-4, "anchor_rotation": 60.0, "anchor_translation": 5e6}


@short_repr
@dataclass(frozen=True)
class AnchorFit:
    """Clamp and anchors as fitted, and how well they meet each measured mode.

    Parameters
    ----------
    structure : ClampOnBeams
        With the length of the first measured beams.
    length : tuple of float
        Of the beams, for each measured mode [m].
    measured, found : tuple of float
        [Hz]
    """

    structure: ClampOnBeams
    length: tuple[float, ...]
    measured: tuple[float, ...]
    found: tuple[float, ...]

    @property
    def errors(self) -> tuple[float, ...]:
        """Relative error of each mode."""
        pairs = zip(self.found, self.measured, strict=True)
        return tuple(found / measured - 1.0 for found, measured in pairs)


def fit_anchors(
    structure: ClampOnBeams,
    measured: Mapping[float, Sequence[float]],
    *,
    free: Sequence[str] = ("clamp_inertia", "anchor_rotation", "anchor_translation"),
) -> AnchorFit:
    """Fit clamp and anchors to measured modes of beams of several lengths.

    Parameters
    ----------
    structure : ClampOnBeams
        Everything that is not free; its length is without meaning.
    measured : mapping of float to sequence of float
        Modes [Hz] by length of the beams [m], the first being that in which the clamp turns.
    free : sequence of str, optional
        Which of ``clamp_inertia``, ``anchor_rotation`` and ``anchor_translation`` are fitted.

    Returns
    -------
    AnchorFit
        The same at each call: the search starts at one place and is deterministic.

    Raises
    ------
    ParameterError
        If a name cannot be fitted, or there are fewer modes than free numbers.

    Examples
    --------
    >>> from models.rig import Beams
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)
    >>> stuck = ClampOnBeams(steel, 0.123, 0.96, 1 / 1050, 6.13e5, 750.0)
    >>> fit = fit_anchors(stuck, {0.123: [250.0], 0.092: [320.0]},
    ...                   free=["clamp_inertia", "anchor_rotation"])
    >>> [round(found) for found in fit.found]
    [250, 320]
    """
    for name in free:
        if name not in _BOUNDS:
            raise ParameterError(f"{name!r} cannot be fitted; there are {', '.join(_BOUNDS)}")
    lengths = tuple(length for length, modes in measured.items() for _ in modes)
    wanted = tuple(mode for modes in measured.values() for mode in modes)
    if len(wanted) < len(free):
        raise ParameterError(f"{len(wanted)} measured modes cannot give {len(free)} numbers")

    def cost(logarithms: NDArray[np.float64]) -> float:
        trial = _with(structure, free, logarithms)
        error = np.log(np.array(_nearest(trial, measured)) / np.array(wanted))
        return float(np.sum(np.abs(100.0 * error) ** _POWER) ** (1.0 / _POWER))

    best = minimize(
        cost,
        [math.log(_START[name]) for name in free],
        method="Nelder-Mead",
        bounds=[tuple(np.log(_BOUNDS[name])) for name in free],
        options={"xatol": 1e-5, "fatol": 1e-6, "maxiter": 600},
    )
    fitted = _with(structure, free, best.x)
    fitted = replace(fitted, length=lengths[0])
    return AnchorFit(fitted, lengths, wanted, tuple(_nearest(fitted, measured)))


def _with(
    structure: ClampOnBeams, free: Sequence[str], logarithms: NDArray[np.float64]
) -> ClampOnBeams:
    values = dict(zip(free, np.exp(logarithms).tolist(), strict=True))
    inertia = values.pop("clamp_inertia", structure.clamp_inertia)
    return replace(structure, clamp_inertia=inertia, beams=replace(structure.beams, **values))


def _nearest(structure: ClampOnBeams, measured: Mapping[float, Sequence[float]]) -> list[float]:
    """Return the mode that each measured one is held against [Hz]."""
    found = []
    for length, modes in measured.items():
        beams = replace(structure, length=length)
        turning, sideways = (
            natural_frequencies(beams, _HEADROOM * max(modes), motion)
            for motion in (RootMotion.TURNING, RootMotion.SIDEWAYS)
        )
        every = np.concatenate([turning, sideways])
        found.append(float(turning[0]))
        found += [float(every[np.abs(np.log(every / mode)).argmin()]) for mode in modes[1:]]
    return found
