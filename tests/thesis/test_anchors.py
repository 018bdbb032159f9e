"""Anchors fitted to measured modes."""

from dataclasses import replace

import numpy as np
import pytest

from noise.thesis.modes import FITTED, MEASURED, fitted_structure, nearest_modes

WANTED = np.concatenate(list(MEASURED.values()))


def cost(structure):
    return np.sum(np.log(np.array(nearest_modes(structure)) / WANTED) ** 4)


def test_anchors_that_yield_bring_all_measured_modes_within_a_tenth():
    assert nearest_modes(fitted_structure("yielding anchors")) == pytest.approx(WANTED, rel=0.10)


@pytest.mark.parametrize("kind", FITTED)
def test_no_neighbour_of_the_fit_is_better(kind):
    structure = fitted_structure(kind)
    best, beams = cost(structure), structure.beams
    for factor in (0.95, 1.05):
        # 10 Nm/rad is the least that was allowed, and rigid is rigid.
        searched = "anchor_translation" if kind.startswith("yield") else "anchor_rotation"
        stiffer = replace(beams, **{searched: factor * getattr(beams, searched)})
        assert cost(replace(structure, beams=stiffer)) > best
        inertia = factor * structure.clamp_inertia
        assert cost(replace(structure, clamp_inertia=inertia)) > best
