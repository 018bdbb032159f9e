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
from noise.thesis.row import Row, number
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

_MODE_TOLERANCE = 0.05


def torsional_modes() -> Iterator[Row]:
    """First torsional mode of the lumped model, measured 250 and 310 Hz (5.2.2)."""
    for support, measured in ((LONG, 250.0), (SHORT, 310.0)):
        for state, stuck in (("sliding", False), ("stuck", True)):
            bushings = (lumped_bushing(rig_of(m), 0.279e-3, support) for m in (THESIS, CALIBRATED))
            exact, calibrated = (float(b.natural_frequencies(stuck=stuck)[0]) for b in bushings)
            yield Row(
                "first_torsional_mode", f"{Case(1.0, 0.279, support).place()}, {state}", "Hz",
                number(measured), exact=exact, calibrated=calibrated, measured=True,
                tolerance=_MODE_TOLERANCE, counted=False,
            )  # fmt: skip


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


def beam_modes() -> Iterator[Row]:
    """Modes that 3.1.1 computes and 5.2.2 measures."""
    beams = rigidly_anchored()
    long, short = clamp_modes(beams, 0.123), clamp_modes(beams, 0.092)
    # Mass and inertia of the clamp were chosen for the two lowest of the long beams.
    for text, printed, mode, in_sample in (
        ("12.3 cm, lowest of 140-2100 Hz", 140.0, long[0], True),
        ("9.2 cm, highest of 140-2100 Hz", 2100.0, short[3], False),
    ):
        yield Row(
            "beam_mode", text, "Hz", number(printed), exact=float(mode), tolerance=_MODE_TOLERANCE,
            in_sample=in_sample,
        )  # fmt: skip
    for text, mode, measured, in_sample in (
        ("12.3 cm, first torsional", long[1], 250.0, True),
        ("9.2 cm, first torsional", short[1], 310.0, False),
        ("12.3 cm, first bending", long[2], 900.0, False),
        ("9.2 cm, first bending", short[2], 1375.0, False),
    ):
        yield Row(
            "beam_mode", text, "Hz", number(measured), exact=float(mode), measured=True,
            tolerance=_MODE_TOLERANCE, in_sample=in_sample, counted=False,
        )  # fmt: skip
    for measured in (4500.0, 6000.0):
        nearest = float(long[np.abs(long - measured).argmin()])
        yield Row(
            "beam_mode", f"12.3 cm, nearest to {measured:g} Hz", "Hz", number(measured),
            exact=nearest, measured=True, tolerance=_MODE_TOLERANCE, counted=False,
        )  # fmt: skip


def squeal() -> list[Row]:
    """6570 Hz of the squeal: most likely rad/s read as Hz."""
    fit = rig_of(THESIS).fit(0.279e-3)
    mode = math.sqrt(fit.elastomer_stiffness / rig_of(THESIS).elastomer_inertia) / (2.0 * math.pi)
    case = Case(10.0, 0.279, SHORT)
    return [
        Row(
            "squeal_frequency", f"{case}; sqrt(k_E / J_E) is 6575 rad/s", "Hz", number(6570.0),
            exact=mode, calibrated=strongest_line(CALIBRATED, case), measured=True,
            meant=number(6570.0 / (2.0 * math.pi)), tolerance=0.01,
        )
    ]  # fmt: skip
