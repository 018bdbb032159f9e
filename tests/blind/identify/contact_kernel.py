"""The compiled loop of the second rig for contacts that creep: bristles with an age.

Velocity Verlet at the same short steps as `tests.blind.kernel`. The shear of the bristles follows
its equation exactly over a step in which sliding speed and strength stand still, which is stable at
any stiffness; the age of the contact likewise.
"""

from __future__ import annotations

import math

from numba import njit

BRISTLE, RATE_AND_STATE, MEMORY = range(3)

(STIFFNESS, VISCOUS, STRENGTH, DROP, SPEED, RENEWAL, TIME, DIRECT, WEAKENING) = range(9)
N_CONTACT = 9

LONGEST = 0.02
"""After which a contact gains no more strength by the logarithm of its age [s]."""


@njit(cache=True, error_model="numpy")
def strength(law, c, speed, age):
    """Torque that a contact of this age bears at this sliding speed."""
    if law == BRISTLE:
        x = speed / c[SPEED]
        return c[STRENGTH] + c[DROP] / (1.0 + x * x)
    if law == RATE_AND_STATE:
        aged = math.log1p(min(age, LONGEST) / c[TIME]) / math.log1p(LONGEST / c[TIME])
        return c[STRENGTH] * (1.0 + c[DIRECT] * math.log1p(speed / 0.05)) + c[DROP] * aged
    aged = 1.0 - math.exp(-math.sqrt(age / c[TIME]))
    fading = c[WEAKENING] / (1.0 + speed / c[SPEED])
    return c[STRENGTH] * (1.0 + fading) + c[DROP] * aged


@njit(cache=True, error_model="numpy")
def integrate(law, c, p, steps, h, omega, result):
    """Fill `result` with the columns of `tests.blind.kernel`; `p` as its first eight scalars."""
    fixed = p[3] < 0.0
    v1, v2, x1, x2 = omega[0], 0.0, 0.0, 0.0
    a1, a2, angle, torque = 0.0, 0.0, 0.0, 0.0
    z, age, drag = 0.0, 1.0, 0.0
    for i in range(result.shape[0]):
        result[i, 0], result[i, 1] = torque, a2
        result[i, 2], result[i, 3], result[i, 4], result[i, 5] = x1, v1, x2, v2
        result[i, 6], result[i, 7], result[i, 8] = drag, omega[i], angle
        for j in range(steps):
            shaft = omega[i] + (omega[i + 1] - omega[i]) * j / steps
            x1 += h * (v1 + 0.5 * h * a1)
            half1 = v1 + 0.5 * h * a1
            guess1 = v1 + h * a1
            half2, guess2 = v2 + 0.5 * h * a2, v2 + h * a2
            if not fixed:
                x2 += h * (v2 + 0.5 * h * a2)
            v = shaft - guess1
            speed = abs(v)
            g = strength(law, c, speed, age)
            settled = g / c[STIFFNESS]
            if v < 0.0:
                settled = -settled
            before = z
            if speed * h > 1e-9 * settled * settled / abs(settled):
                z = settled + (z - settled) * math.exp(-h * speed / abs(settled))
            else:
                z += h * v
            rate = (z - before) / h
            slip = speed
            if law == RATE_AND_STATE:
                slip = speed * min(abs(z / settled), 1.0)
            fade = slip / c[RENEWAL]
            if fade > 1e-9:
                age = 1.0 / fade + (age - 1.0 / fade) * math.exp(-h * fade)
            else:
                age += h
            drag = c[STIFFNESS] * z + c[VISCOUS] * rate
            torque = p[2] * (x1 - x2) + p[4] * (guess1 - guess2)
            a1 = (drag - torque) / p[0]
            v1 = half1 + 0.5 * h * a1
            if not fixed:
                a2 = (torque - p[3] * x2 - p[5] * guess2) / p[1]
                v2 = half2 + 0.5 * h * a2
            angle += h * shaft
