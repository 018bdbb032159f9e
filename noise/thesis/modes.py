"""Modes of beams with a rigid clamp on the bushing, between rigid and between fitted anchors.

The thesis computed the modes of Figure 3.3 by transfer matrices on its five assumptions (3.1.1).
They are computed here exactly on the same assumptions; mass and inertia of the clamp, which it
does not give, are those that meet 140 and 250 Hz with the long beams.

Rigid anchors, assumption (5) of 3.1.1, put the bending modes measured at 900 and 1375 Hz 22 and
42 % too high. Fitted are the anchors' stiffness and the clamp's inertia; what the thesis gives is
kept. An anchor that turns brings both within 5 %, but no mode near 4500 Hz; one that gives way to
the deflection as well, and is then next to a hinge, meets all six within a tenth. The k_B that goes
with either is well below (4.11), yet within the tolerance of the static tests (Table 5.3).

The shipped rig sounds through anchors of its own: there the first torsional mode is the lumped
model's, which leaves the clamp's inertia no choice, and the two springs are those with which the
largest error of the four modes above it is least.

The largest error matters, so the fourth power of the errors is summed. The first frequency of each
length must be the first mode in which the clamp turns, a further one is held against the nearest
mode of either motion, as nothing is known of its shape.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from models.bench import Beams
from models.structure.beams import beam_structure, torsional_stiffness
from noise.thesis.exact_beams import ClampOnBeams, RootMotion, natural_frequencies
from noise.thesis.formulas import INTERFERENCES, LENGTHS, in_series
from noise.thesis.row import Values
from noise.thesis.runs import CALIBRATED, LONG, SHORT, THESIS, rig_of

_LATERAL_STIFFNESS = 3500.0 * 4.4482216 / 0.0254
"""Of the bushing, 3500 lb/in [N/m]."""

_TORSIONAL_STIFFNESS = 750.0
"""Of the bushing [Nm/rad]."""

_CLAMP_MASS, _CLAMP_INERTIA = 0.96, 1 / 1050
"""Assumed [kg], [kg m2]."""

_HIGHEST = 12e3
"""[Hz]"""


def beams() -> Iterator[Values]:
    """Equations (4.11) and (4.12)."""
    beam = rigidly_anchored()
    yield {"exact": beam.width * beam.thickness**3 / 12}
    for length in LENGTHS.values():
        yield {"exact": torsional_stiffness(beam, length)}


def rigidly_anchored() -> Beams:
    """Return the beams as 3.1.1 assumes them.

    Examples
    --------
    >>> rigidly_anchored().anchor_rotation
    inf
    """
    shipped = rig_of(THESIS).beams
    return replace(shipped, anchor_rotation=math.inf, anchor_translation=math.inf)


def clamp_on_beams(beams: Beams, length: float) -> ClampOnBeams:
    """Clamp, bushing and beams of one length [m] on the assumptions of 3.1.1."""
    return ClampOnBeams(
        beams, length, _CLAMP_MASS, _CLAMP_INERTIA, _LATERAL_STIFFNESS, _TORSIONAL_STIFFNESS
    )


def clamp_modes(beams: Beams, length: float) -> NDArray[np.float64]:
    """Modes of beams of one length [m] with the clamp on the bushing [Hz].

    Parameters
    ----------
    beams : Beams
    length : float
        [m]

    Returns
    -------
    ndarray, shape (n_modes,)
        Rising [Hz].

    Examples
    --------
    >>> clamp_modes(rigidly_anchored(), 0.123)[:4].round()
    array([ 140.,  250., 1094., 1152.])
    """
    structure = clamp_on_beams(beams, length)
    found = [
        natural_frequencies(structure, _HIGHEST, motion)
        for motion in (RootMotion.TURNING, RootMotion.SIDEWAYS)
    ]
    return np.sort(np.concatenate(found))


def beam_modes() -> Iterator[Values]:
    """Modes that 3.1.1 computes and 5.2.2 measures, the last two those nearest to 4500 and 6000 Hz.

    Mass and inertia of the clamp were chosen for the two lowest of the long beams.
    """
    long, short = (clamp_modes(rigidly_anchored(), length) for length in (0.123, 0.092))
    near = (long[np.abs(long - measured).argmin()] for measured in (4500.0, 6000.0))
    for mode in (long[0], short[3], long[1], short[1], long[2], short[2], *near):
        yield {"exact": float(mode)}


_POWER = 4
"""Of the relative errors that are summed."""

_HEADROOM = 1.3
"""Modes are looked for up to so many times the highest measured frequency."""

_SEARCHED = {  # start, lowest and highest
    "clamp_inertia": (5e-4, 1e-4, 3e-3),
    "anchor_rotation": (60.0, 10.0, 1e5),
    "anchor_translation": (5e6, 1e5, 1e9),
}
"""[kg m2], [Nm/rad], [N/m]"""


@dataclass(frozen=True)
class AnchorFit:
    """Clamp and anchors as fitted, and the mode that each measured one is held against.

    Parameters
    ----------
    structure : ClampOnBeams
        With the length of the first measured beams.
    found : tuple of float
        [Hz]
    """

    structure: ClampOnBeams
    found: tuple[float, ...]


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

    Examples
    --------
    >>> from models.bench import Beams
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)
    >>> stuck = ClampOnBeams(steel, 0.123, 0.96, 1 / 1050, 6.13e5, 750.0)
    >>> fit = fit_anchors(stuck, {0.123: [250.0], 0.092: [320.0]},
    ...                   free=["clamp_inertia", "anchor_rotation"])
    >>> [round(found) for found in fit.found]
    [250, 320]
    """
    wanted = np.array([mode for modes in measured.values() for mode in modes])

    def cost(logarithms: NDArray[np.float64]) -> float:
        error = np.log(np.array(_nearest(_with(structure, free, logarithms), measured)) / wanted)
        return float(np.sum(np.abs(100.0 * error) ** _POWER) ** (1.0 / _POWER))

    best = minimize(
        cost,
        [math.log(_SEARCHED[name][0]) for name in free],
        method="Nelder-Mead",
        bounds=[tuple(np.log(_SEARCHED[name][1:])) for name in free],
        options={"xatol": 1e-5, "fatol": 1e-6, "maxiter": 600},
    )
    fitted = replace(_with(structure, free, best.x), length=next(iter(measured)))
    return AnchorFit(fitted, tuple(_nearest(fitted, measured)))


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


KINDS = {
    "turning anchors": ("clamp_inertia", "anchor_rotation"),
    "yielding anchors": ("clamp_inertia", "anchor_rotation", "anchor_translation"),
}
"""What is fitted, by what a row calls it."""

_MODES = {LONG: (250.0, 900.0, 4500.0, 6000.0), SHORT: (310.0, 1375.0)}
"""Measured with beams of 12.3 and 9.2 cm (5.2.2) [Hz]."""


def fitted() -> Iterator[Values]:
    """Modes, k_B and effective stiffness, with turning anchors and then with yielding ones."""
    measured = {LENGTHS[support]: modes for support, modes in _MODES.items()}
    structure = clamp_on_beams(rigidly_anchored(), LENGTHS[LONG])
    for free in KINDS.values():
        fit = fit_anchors(structure, measured, free=free)
        of_beams = fit.structure.beams
        supports = [torsional_stiffness(of_beams, length) for length in LENGTHS.values()]
        series = [in_series(THESIS, at, support) for at in INTERFERENCES for support in supports]
        for exact in (*fit.found, *supports, *series):
            yield {"exact": exact}


def shipped() -> Iterator[Values]:
    """Modes by which the torque reaches accelerometer and anchors of the shipped rig.

    Examples
    --------
    >>> [round(values["calibrated"]) for values in shipped()]
    [259, 992, 4050, 6619, 337, 1489]
    """
    rig = rig_of(CALIBRATED)
    for support, modes in _MODES.items():
        found = beam_structure(
            rig.beams, support, rig.clamp_inertia, 0.01, 1.3 * max(modes)
        ).frequencies
        nearest = (found[np.abs(np.log(found / measured)).argmin()] for measured in modes[1:])
        for mode in (found[0], *nearest):
            yield {"calibrated": float(mode)}
