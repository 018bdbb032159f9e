"""A slider pulled over a surface through a spring, compiled.

While it sticks the force grows linearly, so only the samples are visited; while it slips the
motion is stepped finely. Friction coefficients are shares of the weight, as is the force.
"""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["slide"]


@njit(cache=True)
def slide(samples, rate, steps, pull, omega, weight_speed, law, heights, spacing):
    """Spring force over weight at the sampling instants.

    Parameters
    ----------
    samples : int
        How many to return.
    rate : float
        Sampling rate [Hz].
    steps : int
        Steps a sample while it slips.
    pull : float
        Speed of the spring's far end [m/s].
    omega : float
        Natural frequency of the slider on its spring [rad/s].
    weight_speed : float
        Speed that gravity gives in a second, divided by what inertia exceeds the weight's: 9.81 for
        a plain mass [m/s].
    law : ndarray, shape (8,)
        Static and kinetic coefficient, growth of the static one a factor e of waiting [1], its
        time [s], fall of the kinetic one with speed [1], its speed [m/s], viscous coefficient
        [s/m], scatter of both [1].
    heights : ndarray, shape (n,)
        Surface: standard deviates that the scatter multiplies, one every `spacing` of sliding,
        repeated after the last.
    spacing : float
        [m].

    Returns
    -------
    ndarray, shape (samples,)
        Spring force over weight.
    """
    static, kinetic, growth, waiting, fall, scale, viscous, scatter = law
    force_of = np.empty(samples)
    h = 1.0 / (rate * steps)
    slope = omega * omega / weight_speed  # force over weight a metre of the spring
    place = 0.0
    speed = 0.0
    force = kinetic
    rest = 0.0
    sticking = True
    for i in range(samples):
        force_of[i] = force
        here = scatter * heights[int(place / spacing) % len(heights)]
        if sticking:
            force += slope * pull / rate
            rest += 1.0 / rate
            if force > static + here + growth * np.log1p(rest / waiting):
                sticking = False
                speed = 0.0
            continue
        for _ in range(steps):
            here = scatter * heights[int(place / spacing) % len(heights)]
            drag = kinetic + here - fall * (1.0 - np.exp(-speed / scale)) + viscous * speed
            speed += h * weight_speed * (force - drag)
            if speed <= 0.0:
                speed = 0.0
                sticking = True
                rest = 0.0
                break
            place += h * speed
            force += slope * (pull - speed) * h
        if sticking:
            continue
    return force_of
