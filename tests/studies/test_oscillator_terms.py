"""A linear oscillator's missing term is named: in the library's own form, and in other forms."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from numba import njit

from models.errors import ParameterError
from tests.helpers.driven_oscillators import GAIN, RATE, driven_record
from tests.studies.oscillator_terms import (
    LIBRARY,
    DrivenRecord,
    Oscillator,
    Term,
    diagnose_oscillator,
)
from tests.studies.oscillator_terms.motion import FORCE_SIGNATURE, move, no_force
from tests.studies.oscillator_terms.oscillator import predicted

TRUE = Oscillator(68.0, 0.05, GAIN)
QUIET = [(150, 2450)]
BLOCKS = [(start, start + 900) for start in range(2800, 11_000, 1000)]
TRAIN = BLOCKS[0::3]
HELD_OUT = {"held out": BLOCKS[1::3] + BLOCKS[2::3]}


def answer(record, nominal=None, library=LIBRARY):
    return diagnose_oscillator(
        record, QUIET, TRAIN, HELD_OUT, np.random.default_rng(0), nominal, library
    )


def late(x, samples):
    angle = 2.0 * np.pi * np.fft.rfftfreq(len(x))
    return np.fft.irfft(np.fft.rfft(x) * np.exp(-1j * angle * samples), len(x))


def lagging(x, samples, order=1):
    s = 2j * np.pi * np.fft.rfftfreq(len(x)) * samples
    return np.fft.irfft(np.fft.rfft(x) / (1.0 + s / order) ** order, len(x))


OWN = {
    "quadratic_stiffness": {"force": "x^2", "strength": 0.05},
    "cubic_stiffness": {"force": "x^3", "strength": 0.02},
    "coulomb_friction": {"force": "sign v", "strength": 0.05},
    "quadratic_damping": {"force": "v|v|", "strength": 0.03},
    "cubic_damping": {"force": "v^3", "strength": 0.01},
    "drift": {"force": "t x", "strength": 0.1},
    "delay": {"sensed": partial(late, samples=0.3)},
    "sensor_pole": {"sensed": partial(lagging, samples=0.4)},
    "output_compression": {"sensed": lambda x: x / np.sqrt(1.0 + 0.03 * x * x)},
    "input_nonlinearity": {"driven": lambda u: u + 0.05 * u * u + 0.03 * u**3},
}

OTHER = [
    ("cubic_stiffness", {"force": "hardening by tanh", "strength": 0.15}),
    ("cubic_stiffness", {"force": "x|x|^1.5", "strength": 0.03}),
    ("cubic_stiffness", {"force": "softening by tanh", "strength": 0.1}),
    ("quadratic_stiffness", {"force": "even root", "strength": 0.2}),
    ("quadratic_stiffness", {"force": "log cosh", "strength": 0.15}),
    ("coulomb_friction", {"force": "Dahl", "strength": 0.05}),
    ("coulomb_friction", {"force": "arctan v", "strength": 0.08}),
    ("quadratic_damping", {"force": "v|v|^0.8", "strength": 0.03}),
    ("cubic_damping", {"force": "sinh v", "strength": 0.08}),
    ("drift", {"force": "relaxing", "strength": 0.15}),
    ("output_compression", {"sensed": lambda x: np.arctan(0.3 * x) / 0.3}),
    ("input_nonlinearity", {"driven": lambda u: np.tanh(0.4 * u) / 0.4}),
    ("input_nonlinearity", {"driven": lambda u: u + 0.05 * np.abs(u)}),
    ("delay", {"sensed": partial(lagging, samples=0.3, order=3)}),
]


def named(kind):
    """The verdict, with the true nominal model where dry friction leaves quiet data stuck."""
    dry = kind.get("force") in ("sign v", "Dahl", "arctan v")
    return answer(driven_record(**kind), TRUE if dry else None)


def test_a_linear_oscillator_has_no_gap():
    told = answer(driven_record())
    assert told.verdict == "none"
    assert told.first.closed["held out"] is None
    assert told.gap_recalibrated["held out"].value == pytest.approx(told.floor.value, rel=0.1)


def test_the_cubic_spring_is_named_with_its_strength_and_its_parameters_come_back():
    told = answer(driven_record(**OWN["cubic_stiffness"]))
    assert told.verdict == "cubic_stiffness"
    assert told.equivalent == ("cubic_stiffness",)
    assert not told.remainder_is_real
    closed = told.first.closed["held out"]
    assert closed.low <= closed.value <= closed.high
    assert closed.low > 0.97
    assert abs(told.shifts(told.recalibrated)["frequency"]) > 0.02
    assert abs(told.shifts(told.first.oscillator)["frequency"]) < 0.002
    assert 0.0 < told.hidden["held out"] < 1.0
    assert "a spring that hardens" in told.table("mV", 1e3)


def test_a_hardening_of_another_form_is_a_spring_with_a_remainder():
    told = named(OTHER[0][1])
    assert told.verdict == "cubic_stiffness"
    assert told.remainder_is_real
    assert "no term of the library" in told.sentence()


def test_a_term_of_the_users_own_joins_the_library():
    @njit(FORCE_SIGNATURE)
    def force(x, v, t, p):
        return p[0] * x * abs(x) ** 1.5

    own = Term("my_spring", "a spring of mine", (-0.5,), (0.5,), force)
    told = answer(driven_record(**OTHER[1][1]), library=(LIBRARY[1], own))
    assert told.verdict == "my_spring"
    assert told.findings[1].name == "cubic_stiffness"
    assert not told.remainder_is_real


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_no_linear_oscillator_has_a_gap(seed):
    assert answer(driven_record(seed=100 + seed)).verdict == "none"


@pytest.mark.slow
@pytest.mark.parametrize("term", OWN)
def test_every_term_is_named_in_its_own_form(term):
    told = named(OWN[term])
    assert told.verdict == term
    assert told.first.closed_by_effect["held out"].value > 0.9


@pytest.mark.slow
@pytest.mark.parametrize(("term", "kind"), OTHER, ids=lambda value: str(value)[:40])
def test_a_term_is_named_in_forms_that_the_library_has_not(term, kind):
    assert named(kind).verdict == term


@pytest.mark.slow
@pytest.mark.parametrize("force", ["echo", "second mode"])
def test_a_stranger_is_unknown(force):
    told = answer(driven_record(force=force, strength=0.1))
    assert told.verdict == "unknown"
    assert told.remainder_is_real


def test_held_out_data_may_not_be_fitted():
    record = driven_record()
    with pytest.raises(ParameterError, match="is fitted to as well"):
        diagnose_oscillator(record, QUIET, TRAIN, {"a": TRAIN}, np.random.default_rng(0))


def test_a_span_outside_the_record_is_refused():
    record = driven_record()
    with pytest.raises(ParameterError, match=r"span 0\.\.20000 must have 300 samples"):
        diagnose_oscillator(record, [(0, 20_000)], TRAIN, HELD_OUT, np.random.default_rng(0))


def test_noise_without_an_oscillator_asks_for_the_nominal_model():
    rng = np.random.default_rng(0)
    record = DrivenRecord(rng.standard_normal(12_000), rng.standard_normal(12_000), RATE)
    with pytest.raises(ParameterError, match="not that of an oscillator"):
        answer(record)


def test_a_record_needs_two_series_that_vary():
    with pytest.raises(ParameterError, match="two series of one length"):
        DrivenRecord(np.zeros(3), np.zeros(4), RATE)
    with pytest.raises(ParameterError, match="constant"):
        DrivenRecord(np.zeros(3), np.arange(3.0), RATE)


def test_the_motion_is_that_of_the_transfer_function():
    """A sine at resonance ends at gain / (2 damping) of the static displacement."""
    steps, rate, damping = 4, 1000.0, 0.05
    time = np.arange(2000 * 2 * steps) / (rate * 2 * steps)
    omega = 2.0 * np.pi * 60.0
    x = move(
        np.sin(omega * time), steps, rate, omega, damping, 2.0, omega, 0.0, 0.0, no_force,
        np.zeros(0),
    )  # fmt: skip
    assert np.max(np.abs(x[1000:])) == pytest.approx(2.0 / (2.0 * damping), rel=2e-3)


def test_every_term_at_zero_strength_is_the_linear_model():
    record = driven_record()
    span = (3000, 4000)
    plain = predicted(record, TRUE.array, None, np.zeros(0), TRUE, span)
    for term in LIBRARY:
        with_it = predicted(record, TRUE.array, term, np.zeros(len(term.lowest)), TRUE, span)
        np.testing.assert_allclose(with_it[:-32], plain[:-32], atol=2e-3 * np.std(plain))
