"""The solver of true stick against a general one, and against what physics demands."""

import numpy as np
import pytest
from hypothesis import Phase, assume, given, settings, strategies as st
from scipy.integrate import solve_ivp

from models.errors import ParameterError
from sim.bushing import LumpedBushing
from sim.solvers.stick_slip import advance_stick_slip, rest_state
from tests.helpers.contacts import solve_stick_slip

STEP = 1 / 30e3

PHASES = [Phase.explicit, Phase.reuse, Phase.generate]
"""Without shrinking, which takes minutes here."""

LEAST_MARGIN = 1e-3
"""Left out are grazes: a limit passed more slowly than this share of the typical rate, or missed
by less than this share of it (of T_crit, of the shaft's speed). They are tested apart."""


class Reference:
    """DOP853 at rtol 1e-12, phase by phase; ends of phases polished by Newton's method."""

    def __init__(self, system, critical, kinetic, speed, rate):
        self.system, self.critical, self.kinetic = system, critical, kinetic
        self.speed, self.rate = speed, rate  # of the shaft: speed + rate * t

    def shaft(self, t):
        return self.speed + self.rate * t

    def elastomer(self, t, x, way):
        _, _, k_e, _, c_e, _ = self.system
        surface = self.shaft(t) if way == 0 else x[1]
        return k_e * (x[0] - x[2]) + c_e * (surface - x[3])

    def rates(self, t, x, way):
        j_e, j_c, _, k_b, _, c_b = self.system
        torque = self.elastomer(t, x, way)
        turning = self.rate if way == 0 else (way * self.kinetic - torque) / j_e
        moving = 0.0 if k_b < 0 else (torque - k_b * x[2] - c_b * x[3]) / j_c
        surface = self.shaft(t) if way == 0 else x[1]
        return np.array([surface, turning, x[3], moving])

    def distance(self, t, x, way):
        """From the end of the phase, and how fast it shrinks."""
        j_e, _, k_e, _, c_e, _ = self.system
        rates = self.rates(t, x, way)
        if way == 0:
            holding = self.elastomer(t, x, 0) + j_e * self.rate
            slope = k_e * (rates[0] - rates[2]) + c_e * (rates[1] - rates[3])
            return self.critical - abs(holding), -np.sign(holding) * slope
        return way * (self.shaft(t) - x[1]), way * (self.rate - rates[1])

    def integrate(self, start, end, x, way, events=None):
        return solve_ivp(
            self.rates, (start, end), x, "DOP853", rtol=1e-12, atol=1e-14, args=(way,),
            max_step=1e-4, events=events,
        )  # fmt: skip

    def solve(self, seconds):
        """Times of the events, state at the end, and the least margin from a graze."""
        j_e, _, k_e, _, _, _ = self.system
        typical = {0: k_e * (abs(self.speed) + 1.0), 1: (self.critical - self.kinetic) / j_e}
        events, gentlest = [], np.inf
        start, x, way = 0.0, np.array([0.0, self.shaft(0.0), 0.0, 0.0]), 0
        while True:

            def ends(t, x, way, start=start):
                return self.distance(t, x, way)[0] if t > start + 1e-7 else 1.0

            def turns(t, x, way):
                return self.distance(t, x, way)[1]

            ends.terminal, turns.direction = True, 1.0
            solution = self.integrate(start, seconds, x, way, [ends, turns])
            for t, x in zip(solution.t_events[1], solution.y_events[1], strict=True):
                typical_distance = self.critical if way == 0 else abs(self.shaft(t))
                if start + 1e-7 < t < solution.t[-1]:
                    gentlest = min(gentlest, self.distance(t, x, way)[0] / typical_distance)
            if solution.status != 1:
                return np.array(events), solution.y[:, -1], gentlest
            base, x = solution.t[-2], solution.y[:, -2]
            t = solution.t[-1]
            for _ in range(3):
                at = self.integrate(base, t, x, way).y[:, -1] if t > base else x
                gap, slope = self.distance(t, at, way)
                t -= gap / slope
            x = self.integrate(base, t, x, way).y[:, -1] if t > base else x
            gentlest = min(gentlest, abs(slope) / typical[abs(way)])
            events.append(t)
            start, x[1] = t, self.shaft(t)
            holding = self.elastomer(t, x, 0) + j_e * self.rate
            leaves = way == 0 or abs(holding) > self.critical
            way = int(np.sign(holding)) if leaves else 0


systems = st.builds(
    lambda damping, share, support, elastomer: LumpedBushing(
        1 / 65000, 1 / 1200, elastomer, support, share * damping, (1 - share) * damping
    ).packed(),
    damping=st.floats(0.02, 0.15),
    share=st.floats(0.1, 0.9),
    support=st.one_of(st.floats(1500.0, 6000.0), st.just(np.inf)),
    elastomer=st.floats(400.0, 1100.0),
)


@given(
    system=systems,
    kinetic=st.floats(0.0, 20.0),
    drop=st.floats(0.5, 8.0),
    speed=st.floats(0.3, 8.0),
    way=st.sampled_from([-1.0, 1.0]),
    change=st.sampled_from([0.0, 0.0, -5.0, 30.0]),
)
@settings(max_examples=4, phases=PHASES)
def test_events_and_states_agree_with_a_general_solver(system, kinetic, drop, speed, way, change):
    n = 4501
    shaft = way * (speed + change * STEP * np.arange(n))
    reference = Reference(system, kinetic + drop, kinetic, way * speed, way * change)
    expected, end, gentlest = reference.solve((n - 1) * STEP)
    assume(gentlest > LEAST_MARGIN)
    states, _, events = solve_stick_slip(system, kinetic + drop, kinetic, shaft, STEP)
    known = predictable(system, kinetic + drop, kinetic, shaft, events)
    assert events[:known] == pytest.approx(expected[:known], rel=0.0, abs=1e-10)
    if known == len(events):
        assert len(expected) == known
        assert states[-1, 2:] == pytest.approx(end, rel=1e-7, abs=1e-7)


def predictable(system, critical, kinetic, shaft, events):
    """Count the events until chaos makes 1e-11 s of what the general solver's tolerance is."""
    _, _, moved = solve_stick_slip(system, critical * (1 + 1e-12), kinetic, shaft, STEP)
    n = min(len(events), len(moved))
    return int(np.append(np.abs(events[:n] - moved[:n]) > 1e-11, [True]).argmax())


def test_a_shaft_that_reverses_is_followed_through_zero():
    # From +2 to -4 rad/s at once in one ramp: sticks at the reversal, slips the other way.
    system = LumpedBushing(1 / 65000, 1 / 1200, 665.0, 3745.0, 0.04, 0.04).packed()
    n = 6001
    shaft = 2.0 - 30.0 * STEP * np.arange(n)
    expected, end, _ = Reference(system, 10.7, 8.0, 2.0, -30.0).solve((n - 1) * STEP)
    states, direction, events = solve_stick_slip(system, 10.7, 8.0, shaft, STEP)
    assert np.abs(events - expected).max() < 1e-10
    assert states[-1, 2:] == pytest.approx(end, rel=1e-7, abs=1e-7)
    assert {1, -1} <= set(direction.tolist())


def free(system, x, speed, n, step, kinetic=0.0, critical=1.0, way=1.0):
    """Motion from any state at constant shaft speed."""
    state = rest_state(speed)
    state[:4], state[4] = x, way
    return advance_stick_slip(system, critical, kinetic, np.full(n, speed), step, state, n)


@pytest.mark.parametrize("step", [1e-4, STEP, 1e-5])
@pytest.mark.parametrize("phase", [0.3, 0.7])
@pytest.mark.parametrize("way", [-1, 1])
def test_a_graze_of_the_shafts_speed_is_seen_within_a_step(step, phase, way):
    # An undamped elastomer on a fixed clamp: sliding speed v - A cos(omega t), least at every turn.
    system = np.array([1 / 65000, 1 / 1200, 665.0, -1.0, 0.0, 0.0])
    omega, amplitude = np.sqrt(665.0 * 65000), 3.0
    angle = 1.0 + phase * step * omega
    start = [way * amplitude / omega * np.sin(angle), way * amplitude * np.cos(angle), 0.0, 0.0]
    n = round(0.01 / step)
    for excess, caught in ((1e-9, False), (-1e-9, True)):
        speed = way * amplitude * (1.0 + excess)
        _, _, events = free(system, start, speed, n, step, kinetic=0.0, critical=1e-3, way=way)
        assert (len(events) > 0) == caught


@pytest.mark.parametrize("step", [1e-4, STEP, 1e-5])
@pytest.mark.parametrize("way", [-1, 1])
def test_a_graze_of_the_critical_torque_is_seen_within_a_step(step, way):
    # The shaft holds still and the clamp rings: holding torque k_E B cos(omega t).
    system = np.array([1 / 65000, 1 / 1200, 665.0, 3745.0, 0.0, 0.0])
    peak, omega, n = 0.005, np.sqrt((665.0 + 3745.0) * 1200), round(0.02 / step)
    start = [0.0, 0.0, -way * peak * np.cos(1.1), way * peak * omega * np.sin(1.1)]
    for excess, breaks in ((1e-9, False), (-1e-9, True)):
        critical = 665.0 * peak * (1.0 + excess)
        _, _, events = free(system, start, 0.0, n, step, 0.5 * critical, critical, way=0.0)
        assert (len(events) > 0) == breaks


@pytest.mark.parametrize("cut", [1, 777, 5999])
def test_blocks_joined_are_one_run(cut):
    system = LumpedBushing(1 / 65000, 1 / 1200, 665.0, 2214.0, 0.04, 0.04).packed()
    shaft = 6.0 * np.cos(np.arange(6000) * STEP * 30.0)
    whole, direction, events = solve_stick_slip(system, 10.7, 8.0, shaft, STEP)
    state = rest_state(shaft[0])
    first = advance_stick_slip(system, 10.7, 8.0, shaft[: cut + 1], STEP, state, cut)
    rest = advance_stick_slip(system, 10.7, 8.0, shaft[cut:], STEP, state, 6000 - cut)
    joined = [np.concatenate(pair) for pair in zip(first, rest, strict=True)]
    assert np.array_equal(joined[0], whole)
    assert np.array_equal(joined[1], direction)
    assert np.array_equal(joined[2], events)


def test_a_step_beyond_any_cutting_up_is_refused():
    system = LumpedBushing(1 / 65000, 1 / 1200, 665.0, 3745.0, 0.04, 0.04).packed()
    with pytest.raises(ParameterError, match="too long"):
        solve_stick_slip(system, 10.7, 8.0, np.full(10, 1.0), 10.0)
