"""Modes of the rig: lumped model, beams with a rigid clamp on the bushing, and the elastomer's own.

The thesis computed the modes of Figure 3.3 by transfer matrices on its five assumptions (3.1.1).
They are computed here exactly on the same assumptions; mass and inertia of the clamp, which it
does not give, are those that meet 140 and 250 Hz with the long beams. Anchors that are not rigid,
as the shipped rig's, are in `noise.thesis.anchors`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from models.bench import Beams
from noise.thesis.exact_beams import ClampOnBeams, RootMotion, natural_frequencies
from noise.thesis.row import Values
from noise.thesis.runs import CALIBRATED, LONG, SHORT, THESIS, Case, rig_of, strongest_line
from sim.bushing import lumped_bushing

_LATERAL_STIFFNESS = 3500.0 * 4.4482216 / 0.0254
"""Of the bushing, 3500 lb/in [N/m]."""

_TORSIONAL_STIFFNESS = 750.0
"""Of the bushing [Nm/rad]."""

_CLAMP_MASS, _CLAMP_INERTIA = 0.96, 1 / 1050
"""Assumed [kg], [kg m2]."""

_HIGHEST = 12e3
"""[Hz]"""


def torsional_modes() -> Iterator[Values]:
    """First torsional mode of the lumped model, sliding and stuck (5.2.2)."""
    for support in (LONG, SHORT):
        for stuck in (False, True):
            exact, calibrated = (
                lumped_bushing(rig_of(material), 0.279e-3, support)
                for material in (THESIS, CALIBRATED)
            )
            yield {
                "exact": float(exact.natural_frequencies(stuck=stuck)[0]),
                "calibrated": float(calibrated.natural_frequencies(stuck=stuck)[0]),
            }


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


def squeal() -> Iterator[Values]:
    """6570 Hz of the squeal: most likely rad/s read as Hz."""
    fit = rig_of(THESIS).fit(0.279e-3)
    mode = math.sqrt(fit.elastomer_stiffness / rig_of(THESIS).elastomer_inertia) / (2.0 * math.pi)
    yield {"exact": mode, "calibrated": strongest_line(CALIBRATED, Case(10.0, 0.279, SHORT))}
