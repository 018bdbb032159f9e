"""Contact pressure of a rubber sleeve by Lame, its ends, and what follows for a rig."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

from models.bushing import Sleeve, TemperatureDependence
from models.rig_file import load_material_rig

RIG = load_material_rig("fluorocarbon")


@given(st.floats(0.0, 0.499))
def test_a_long_sleeve_obeys_lame_in_plane_strain(nu):
    """u = A r + B / r solved for its two ends, radial stress by Hooke."""
    sleeve = Sleeve(0.015, 0.006, math.inf, 5e6, nu)
    a, b, delta = 0.015, 0.021, 1e-4
    coefficients = np.linalg.solve([[a, 1 / a], [b, 1 / b]], [delta, 0.0])
    g = 5e6 / (2 * (1 + nu))
    stress = 2 * g * (coefficients[0] / (1 - 2 * nu) - coefficients[1] / a**2)
    assert sleeve.pressure(delta) == pytest.approx(-stress)


@pytest.mark.parametrize(
    ("wall", "length", "nu"), [(0.0045, 0.0408, 0.4995), (0.006, 0.03, 0.45), (0.003, 0.02, 0.499)]
)
def test_finite_elements_find_the_pressure_of_a_sleeve_with_ends(wall, length, nu):
    sleeve = Sleeve(0.015, wall, length, 7.05e6, nu)
    assert sleeve.pressure(1e-4) == pytest.approx(by_elements(sleeve, 1e-4), rel=0.1)


def by_elements(sleeve, interference, n_r=8, n_z=32):
    """Mean pressure by axisymmetric elements of nine nodes, volume integrated at four points."""
    e, nu = sleeve.youngs_modulus, sleeve.poisson_ratio
    g, lame = e / (2 * (1 + nu)), e * nu / ((1 + nu) * (1 - 2 * nu))
    r = np.linspace(sleeve.inner_radius, sleeve.outer_radius, 2 * n_r + 1)
    z = np.linspace(0.0, sleeve.length, 2 * n_z + 1)
    deviatoric, volume = np.diag([2.0, 2.0, 2.0, 1.0]) * g, np.zeros((4, 4))
    volume[:3, :3] = lame
    rows, columns, values = [], [], []
    for i in range(0, 2 * n_r, 2):
        for j in range(0, 2 * n_z, 2):
            nodes = [(i + p) * z.size + j + q for p in range(3) for q in range(3)]
            stiffness = np.zeros((18, 18))
            for order, law in ((3, deviatoric), (2, volume)):
                points, weights = np.polynomial.legendre.leggauss(order)
                for s, ws in zip(points, weights, strict=True):
                    for t, wt in zip(points, weights, strict=True):
                        b, radius = strain(s, t, r[i : i + 3], z[j : j + 3])
                        area = 0.25 * (r[i + 2] - r[i]) * (z[j + 2] - z[j])
                        stiffness += ws * wt * area * 2 * math.pi * radius * b.T @ law @ b
            dofs = [2 * node + k for node in nodes for k in range(2)]
            rows += np.repeat(dofs, 18).tolist()
            columns += dofs * 18
            values += stiffness.ravel().tolist()
    n = 2 * r.size * z.size
    matrix = coo_matrix((values, (rows, columns)), shape=(n, n)).tocsr()
    inner = 2 * np.arange(z.size)
    outer = np.arange(n - 2 * z.size, n)
    known = np.concatenate([inner, outer])
    u = np.zeros(n)
    u[inner] = interference
    free = np.setdiff1d(np.arange(n), known)
    u[free] = spsolve(matrix[free][:, free].tocsc(), -matrix[free] @ u)
    return float((matrix @ u)[inner].sum() / (2 * math.pi * sleeve.inner_radius * sleeve.length))


def strain(s, t, r, z):
    """Strains of the displacements of nine nodes at a point: radial, axial, hoop, shear."""
    shape = [[0.5 * x * (x - 1), 1 - x * x, 0.5 * x * (x + 1)] for x in (s, t)]
    slope = [[x - 0.5, -2 * x, x + 0.5] for x in (s, t)]
    n = np.outer(*shape).ravel()
    by_r = np.outer(slope[0], shape[1]).ravel() * 2 / (r[2] - r[0])
    by_z = np.outer(shape[0], slope[1]).ravel() * 2 / (z[2] - z[0])
    radius = float(np.dot(shape[0], r))
    b = np.zeros((4, 18))
    b[0, 0::2], b[1, 1::2], b[2, 0::2] = by_r, by_z, n / radius
    b[3, 0::2], b[3, 1::2] = by_z, by_r
    return b, radius


@given(st.floats(0.5, 2.0))
def test_a_longer_bushing_bears_more_torque_than_its_length_says(factor):
    """Its ends, where the rubber gives way, are a smaller part of it."""
    changed = RIG.changed(length=f"x{factor}")
    for before, after in zip(RIG.fits, changed.fits, strict=True):
        ratio = after.kinetic_torque / before.kinetic_torque
        assert (ratio >= factor) == (factor >= 1.0)
        assert after.critical_torque / before.critical_torque == pytest.approx(ratio)
        assert after.elastomer_stiffness == pytest.approx(factor * before.elastomer_stiffness)
    assert changed.elastomer_inertia == pytest.approx(factor * RIG.elastomer_inertia)


GLASS = st.floats(-120.0, 20.0)
ABOVE = st.floats(0.5, 200.0)


@given(GLASS, ABOVE, st.floats(0.0, 200.0), st.floats(0.1, 100.0))
def test_warmth_shifts_rates_down_and_takes_damping_away(glass, reference, above, more):
    rubber = TemperatureDependence(glass + reference, glass, exponent=0.5)
    cold, warm = glass + above, glass + above + more
    assert rubber.log_shift(warm) < rubber.log_shift(cold)
    if warm < rubber.range[1]:  # beyond, entropy outgrows what the rates lose
        assert rubber.damping_factor(warm) < rubber.damping_factor(cold)
