"""What is known of a law's numbers before they are fitted, and what recordings scatter by."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from noise.identification.law_model import LOCAL, LawModel

if TYPE_CHECKING:
    from noise.identification.evidence import Evidence


_SCATTER = np.array([0.025, 0.025, 0.03, 0.03, 0.02, 0.008, 0.01])
"""By which they scatter about the rig's [-]; a support's counts as its clamp's inertia;
assumed."""

_MEAN_WIDTH = np.array([0.6, 0.3, 1.0, 0.6])
"""Relative standard deviation of the rig's about what is usual, or where a search begins [-];
assumed."""

_USUAL_DAMPING = 0.09
"""[Nm s/rad] (Table 5.5)"""

SHARE_ASSUMED = 0.02
"""Relative standard error of a share that the recordings cannot tell; assumed."""


def share_error(model: LawModel) -> float:
    """Relative standard error of the elastomer's share of the damping beforehand [-].

    What rings while the contact sticks tells all of it, while it slides the elastomer's; a
    clamp that is bolted down only this.

    Parameters
    ----------
    model : LawModel
    """
    if all(math.isinf(one.support) for one in model.subjects):
        return SHARE_ASSUMED
    return model.known.share_error


def fitted_evidence(model: LawModel) -> dict[Evidence, int]:
    """Return the group that each piece of evidence speaks of, where the fit has one.

    Parameters
    ----------
    model : LawModel

    Returns
    -------
    dict of Evidence to int
        Torques are left out: those that a table states are levels, a law's are not.
    """
    places = {group: g for g, group in enumerate(model.groups)}
    found = {}
    for one in model.evidence:
        if one.name not in LOCAL or one.name == "kinetic_torque":
            continue
        fit, support = one.interference, one.support_stiffness
        i = LOCAL.index(one.name)
        key: object = {"elastomer_stiffness": fit, "damping": (fit, support)}.get(one.name)
        if (i, key) in places:
            found[one] = places[i, key]
    return found


def priors(model: LawModel, loose: float = 1.0) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return what is known of a vector x: matrix @ x - target is away by one each.

    Parameters
    ----------
    model : LawModel
    loose : float
        Factor on what recordings may differ by [-].

    Returns
    -------
    matrix : ndarray, shape (n_known, n)
        [-]
    target : ndarray, shape (n_known,)
        [-]
    """
    n = model.n_common + model.candidate.n_parameters
    rows, target = [], []

    def row(places: dict[int, float], value: float) -> None:
        line = np.zeros(n)
        for place, factor in places.items():
            line[place] = factor
        rows.append(line)
        target.append(value)

    for r, groups in enumerate(model.group_of.tolist()):
        for i, group in enumerate(groups):
            weight = 1.0 / (loose * _SCATTER[i])
            row({len(LOCAL) * r + i: weight, model.n_local + group: -weight}, 0.0)
    own = np.stack([one.start for one in model.subjects])
    inertia = model.known.inertia_error
    width = np.array([*_MEAN_WIDTH, inertia, inertia, share_error(model)])
    for g, (i, _) in enumerate(model.groups):
        usual = float(np.median(own[model.group_of[:, i] == g, i]))
        if i == LOCAL.index("damping"):
            usual = math.log(_USUAL_DAMPING)
        row({model.n_local + g: 1.0 / width[i]}, usual / width[i])
    for one, g in fitted_evidence(model).items():
        i = model.groups[g][0]
        error = math.hypot(one.error, _SCATTER[i])
        row({model.n_local + g: 1.0 / error}, math.log(one.value) / error)
    for j, (low, high, _) in enumerate(model.candidate.free.values()):
        weight = 2.0 / math.log(high / low)
        row({model.n_common + j: weight}, weight * 0.5 * math.log(low * high))
    return np.array(rows), np.array(target)
