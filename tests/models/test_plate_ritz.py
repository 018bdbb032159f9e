from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from models.bench import Plate
from models.structure.plate import plate_modes
from models.structure.plate_ritz import ritz_modes

CANTILEVER = ("clamped", "free", "free", "free")
BENCH = Plate(0.9, 0.6, 8e-3, 2e11, 7850.0, 0.3, 0.03, (0.0, 0.12), edges="free")


def _square(edges, count, spare_degrees=14):
    """Frequency parameters omega a^2 sqrt(rho h / D) of a square plate, rigid motions left out."""
    edges = (edges,) * 4 if isinstance(edges, str) else edges
    parameters = (
        2 * np.pi * ritz_modes((1.0, 1.0), edges, 0.3, 1.0, 12.0, spare_degrees).frequencies
    )
    return parameters[parameters > 0][:count]


@pytest.mark.parametrize(
    ("edges", "converged"),
    [
        ("clamped", [35.9852, 73.3938, 73.3938]),
        ("free", [13.468, 19.596, 24.270, 34.801]),
        (CANTILEVER, [3.4710, 8.5065, 21.2846]),
    ],
)
def test_square_plates_have_the_converged_frequency_parameters(edges, converged):
    assert _square(edges, len(converged)) == pytest.approx(converged, rel=1e-4)


def test_trial_functions_find_the_closed_form_of_simply_supported_edges():
    exact = plate_modes(dataclasses.replace(BENCH, edges="simply_supported"), 6e3).frequencies
    stiffness = BENCH.stiffness_per_mass
    found = ritz_modes((0.9, 0.6), ("simply_supported",) * 4, 0.3, stiffness, 6e3).frequencies
    assert found == pytest.approx(exact, rel=1e-8)


@given(
    st.lists(st.sampled_from(["free", "simply_supported", "clamped"]), min_size=4, max_size=4),
    st.integers(0, 3),
    st.floats(0.4, 2.5),
)
@settings(max_examples=25)
def test_holding_an_edge_more_lowers_no_frequency(edges, held, ratio):
    def lowest(edges):
        return ritz_modes((ratio, 1.0), tuple(edges), 0.3, 1.0, 8.0).frequencies

    more = [*edges[:held], "clamped", *edges[held + 1 :]]
    looser, tighter = lowest(edges), lowest(more)
    assert tighter.size <= looser.size
    assert np.all(tighter >= looser[: tighter.size] * (1 - 1e-6) - 1e-6)


@pytest.mark.parametrize("edges", ["simply_supported", "clamped", "free", CANTILEVER])
def test_modes_are_orthogonal_with_their_modal_mass(edges):
    modes = plate_modes(dataclasses.replace(BENCH, edges=edges), 2e3)
    nodes, weight = np.polynomial.legendre.leggauss(60)
    shapes = modes.on_grid(0.45 * nodes, 0.3 * nodes, slice(None)).reshape(3600, -1)
    area = (np.outer(weight, weight) * 0.45 * 0.3).reshape(-1, 1)
    masses = shapes.T @ (area * shapes) * BENCH.mass_per_area
    assert masses == pytest.approx(modes.mass * np.eye(len(masses)), abs=1e-7 * modes.mass)


@pytest.mark.parametrize("direction", ["x", "y"])
@pytest.mark.parametrize("edges", ["simply_supported", "free"])
def test_slopes_are_the_derivatives_of_shapes(edges, direction):
    modes = plate_modes(dataclasses.replace(BENCH, edges=edges), 3e3)
    step = 1e-6
    dx, dy = (step, 0.0) if direction == "x" else (0.0, step)
    pair = (modes.shape(0.1 + dx, 0.05 + dy) - modes.shape(0.1 - dx, 0.05 - dy)) / (2 * step)
    assert modes.slope(0.1, 0.05, direction) == pytest.approx(pair, abs=1e-5)


def test_a_free_plate_moves_as_a_whole_as_heavy_as_it_is():
    modes = plate_modes(BENCH, 16e3)
    rigid = modes.frequencies == 5.0
    assert np.count_nonzero(rigid) == 3
    assert modes.frequencies[3] > 40
    acceleration = np.sum(modes.shape(0.0, 0.0)[rigid] ** 2) / modes.mass  # of the middle, for 1 N
    assert acceleration == pytest.approx(1 / (7850 * 8e-3 * 0.9 * 0.6), rel=1e-9)


def test_loss_factors_by_frequency_are_powers_between_entries():
    table = ((300.0, 0.1), (1e3, 0.03))
    modes = plate_modes(dataclasses.replace(BENCH, edges="clamped", loss_factor=table), 2e3)
    inside = (modes.frequencies > 300.0) & (modes.frequencies < 1e3)
    assert np.count_nonzero(inside) > 5
    assert modes.damping_ratios[inside] == pytest.approx(15 / modes.frequencies[inside], rel=1e-9)
    assert modes.damping_ratios[[0, -1]] == pytest.approx([0.05, 0.015], rel=1e-9)
