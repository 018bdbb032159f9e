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

The largest error matters, so the fit has the least sum of the errors' fourth powers. The first
frequency of each length must be the first mode in which the clamp turns, a further one is held
against the nearest mode of either motion, as nothing is known of its shape.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

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
    """Yield the results of equations (4.11) and (4.12)."""
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
    """Return clamp, bushing and beams of one length [m] on the assumptions of 3.1.1."""
    return ClampOnBeams(
        beams, length, _CLAMP_MASS, _CLAMP_INERTIA, _LATERAL_STIFFNESS, _TORSIONAL_STIFFNESS
    )


def clamp_modes(beams: Beams, length: float) -> NDArray[np.float64]:
    """Return the modes of beams of one length [m] with the clamp on the bushing [Hz].

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
    return np.sort(
        np.concatenate([natural_frequencies(structure, _HIGHEST, motion) for motion in RootMotion])
    )


def beam_modes() -> Iterator[Values]:
    """Yield the modes of 3.1.1 and 5.2.2, the last two those nearest to 4500 and 6000 Hz.

    Mass and inertia of the clamp were chosen for the two lowest of the long beams.
    """
    long, short = (clamp_modes(rigidly_anchored(), length) for length in (0.123, 0.092))
    near = (long[np.abs(long - measured).argmin()] for measured in (4500.0, 6000.0))
    for mode in (long[0], short[3], long[1], short[1], long[2], short[2], *near):
        yield {"exact": float(mode)}


FITTED = {  # clamp's inertia [kg m2]; the anchors' stiffness [Nm/rad], [N/m]
    "turning anchors": (5.2583e-4, 154.944, math.inf),
    "yielding anchors": (4.51605e-4, 10.0, 4.76953e6),
}
"""Clamp and anchors with which the fourth powers of the errors of `MEASURED` sum to the least, by
what a row calls them; 10 Nm/rad is the least stiffness that was allowed."""

MEASURED = {LONG: (250.0, 900.0, 4500.0, 6000.0), SHORT: (310.0, 1375.0)}
"""Measured with beams of 12.3 and 9.2 cm (5.2.2) [Hz]."""


def nearest_modes(structure: ClampOnBeams) -> list[float]:
    """Return the mode of a structure that each of `MEASURED` is held against [Hz].

    Parameters
    ----------
    structure : ClampOnBeams
        Its length is replaced by those that were measured.

    Examples
    --------
    >>> structure = clamp_on_beams(rigidly_anchored(), 0.123)
    >>> [round(mode) for mode in nearest_modes(structure)]
    [250, 1094, 5844, 5878, 321, 321]
    """
    nearest = []
    for support, measured in MEASURED.items():
        beams = replace(structure, length=LENGTHS[support])
        turning, sideways = (
            natural_frequencies(beams, 1.3 * max(measured), motion) for motion in RootMotion
        )
        modes = np.concatenate([turning, sideways])
        nearest.append(float(turning[0]))
        nearest += [float(modes[np.abs(np.log(modes / one)).argmin()]) for one in measured[1:]]
    return nearest


def fitted_structure(kind: str) -> ClampOnBeams:
    """Return clamp and beams with the anchors of one of `FITTED`; the beams are the long ones."""
    inertia, rotation, translation = FITTED[kind]
    beams = replace(rigidly_anchored(), anchor_rotation=rotation, anchor_translation=translation)
    return replace(clamp_on_beams(beams, LENGTHS[LONG]), clamp_inertia=inertia)


def fitted() -> Iterator[Values]:
    """Yield modes, k_B and effective stiffness, with turning and then with yielding anchors."""
    for kind in FITTED:
        structure = fitted_structure(kind)
        lengths = LENGTHS.values()
        supports = [torsional_stiffness(structure.beams, length) for length in lengths]
        series = [in_series(THESIS, at, support) for at in INTERFERENCES for support in supports]
        for exact in (*nearest_modes(structure), *supports, *series):
            yield {"exact": exact}


def shipped() -> Iterator[Values]:
    """Yield the modes by which the torque reaches accelerometer and anchors of the shipped rig.

    Examples
    --------
    >>> [round(values["calibrated"]) for values in shipped()]
    [259, 992, 4050, 6619, 337, 1489]
    """
    rig = rig_of(CALIBRATED)
    for support, modes in MEASURED.items():
        computed = beam_structure(
            rig.beams, support, rig.clamp_inertia, 0.01, 1.3 * max(modes)
        ).frequencies
        nearest = (computed[np.abs(np.log(computed / one)).argmin()] for one in modes[1:])
        for mode in (computed[0], *nearest):
            yield {"calibrated": float(mode)}
