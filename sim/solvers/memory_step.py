# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any
# ruff: noqa: ANN001, ANN202
"""A step of the contact with memory, alone or with scatter of its critical torque.

Calibrated materials have this contact. What `sim.solvers.contact_rates` does through pointers and
memory for any law and any effects is done here in registers, by the same operations in the same
order, so that not a bit differs.
"""

from __future__ import annotations

from typing import Any

from numba import njit

from models.compilation import PART
from sim.effects.critical_torque_scatter import scattered
from sim.friction.contact_with_memory import memory_rates
from sim.solvers.contact_state import N_MOTION, N_STAGES
from sim.solvers.tsitouras import NODES, STAGES

__all__ = ["memory_friction", "memory_numbers", "memory_stages", "scattered_stages"]

_inlined = njit(forceinline=True, **PART)


def _written_out(arguments: str, *values: str) -> Any:
    """Return the compiled function of these arguments that returns these expressions."""
    space: dict[str, Any] = {}
    exec(f"def written_out({arguments}):\n    return ({', '.join(values)},)", space)
    return _inlined(space["written_out"])


def _state_at(stage: int, n: int) -> Any:
    """Return the function that tells `n` variables at a stage, from their start and rates."""
    terms = [[f"{STAGES[stage, b]!s} * k{b}[{j}]" for b in range(stage)] for j in range(n)]
    rates = ", ".join(f"k{b}" for b in range(stage))
    values = [f"y[{j}] + h * ({' + '.join(term)})" for j, term in enumerate(terms)]
    return _written_out(f"y, h, {rates}", *values)


@_inlined
def memory_numbers(bushing) -> Any:
    """Return the numbers of bushing and law that its rates read."""
    s, c = bushing.system, bushing.coefficients
    return (
        (s[2], s[3], s[4], s[5], s[6], s[7], s[8], s[9]),
        (c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7]),
    )


@_inlined
def memory_friction(
    v, even, z, age, place, formed, numbers, draws
) -> tuple[float, float, float, float, float]:
    """Return friction torque [Nm], the rates of shear and age, and those of the scatter.

    `v` is the sliding speed, `even` that of the shaft [rad/s]; None for `draws` is no scatter.
    """
    s, c = numbers
    critical, kinetic, burst, forming = s[6], s[7], 0.0, 0.0
    if draws is not None:
        share, burst, forming = scattered(v, even, place, formed, draws)
        critical = kinetic + share * (critical - kinetic)
    friction, shearing, ageing = memory_rates(v, critical, kinetic, z, age, c)
    return friction, shearing, ageing, burst, forming


def _stages(n: int) -> Any:
    """Return the function that makes all stages of a step of `n` variables."""
    at1, at2, at3, at4, at5, at6 = (_state_at(stage, n) for stage in range(1, N_STAGES))
    row = _written_out("a", *[f"a[{j}]" for j in range(n)])
    column = _written_out("k", *[f"k[{j}, 0]" for j in range(n)])
    with_scatter = n > N_MOTION + 2

    @_inlined
    def shaft_at(stage, t0, h, i0, i_last, drive):
        t = t0 + NODES[stage] * h
        i = min(max(int(t / drive.step), i0), i_last)
        return drive.speed[i] + drive.slope[i] * (t - i * drive.step)

    @_inlined
    def rates(y, shaft, numbers, draws):
        k_e, k_b, c_e, c_b, j_e_inverse, j_c_inverse = numbers[0][:6]
        e = k_e * (y[0] - y[2]) + c_e * (y[1] - y[3])
        clamp = (e - k_b * y[2] - c_b * y[3]) * j_c_inverse
        if with_scatter:
            friction, shearing, ageing, burst, forming = memory_friction(
                shaft - y[1], shaft, y[4], y[5], y[6], y[7], numbers, draws
            )
            turning = (friction - e) * j_e_inverse
            return y[1], turning, y[3], clamp, shearing, ageing, burst, forming
        friction, shearing, ageing, _, _ = memory_friction(
            shaft - y[1], shaft, y[4], y[5], 0.0, 0.0, numbers, None
        )
        return y[1], (friction - e) * j_e_inverse, y[3], clamp, shearing, ageing

    @_inlined
    def stages(begin, t0, h, i0, i_last, drive, bushing, draws, start, k, u):
        """Fill `k` and `u`; return the sliding speed at the start, the shaft's at the end."""
        numbers, y = memory_numbers(bushing), row(start)
        shaft = shaft_at(0, t0, h, i0, i_last, drive)
        first = shaft - y[1]
        k0 = rates(y, shaft, numbers, draws) if begin == 0 else column(k)
        shaft = shaft_at(1, t0, h, i0, i_last, drive)
        k1 = rates(at1(y, h, k0), shaft, numbers, draws)
        shaft = shaft_at(2, t0, h, i0, i_last, drive)
        k2 = rates(at2(y, h, k0, k1), shaft, numbers, draws)
        shaft = shaft_at(3, t0, h, i0, i_last, drive)
        k3 = rates(at3(y, h, k0, k1, k2), shaft, numbers, draws)
        shaft = shaft_at(4, t0, h, i0, i_last, drive)
        k4 = rates(at4(y, h, k0, k1, k2, k3), shaft, numbers, draws)
        shaft = shaft_at(5, t0, h, i0, i_last, drive)
        k5 = rates(at5(y, h, k0, k1, k2, k3, k4), shaft, numbers, draws)
        shaft = shaft_at(6, t0, h, i0, i_last, drive)
        end = at6(y, h, k0, k1, k2, k3, k4, k5)
        k6 = rates(end, shaft, numbers, draws)
        for j in range(n):
            k[j, 0], k[j, 1], k[j, 2], k[j, 3] = k0[j], k1[j], k2[j], k3[j]
            k[j, 4], k[j, 5], k[j, 6] = k4[j], k5[j], k6[j]
            u[j] = end[j]
        return first, shaft

    return stages


memory_stages = _stages(N_MOTION + 2)
scattered_stages = _stages(N_MOTION + 4)
"""With two variables of the scatter; the lag of the shaft's end after them stays as it is."""
