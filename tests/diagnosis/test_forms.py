"""What beams do is estimated from recordings, and found in others."""

from __future__ import annotations

import numpy as np
import pytest

from models.rig import LawSpec
from models.transfer_functions.transfer_function import TransferFunction
from noise.diagnosis.fit.case_comparison import CaseComparison
from noise.diagnosis.fit.estimated_forms import estimated_forms, wiener_estimate
from noise.diagnosis.simulated.model_runs import Model
from sim.effects import EFFECTS
from tests.helpers.small_rigs import RIG, at, run

SPEEDS = (1.0, 1.6, 2.5)

BEAMS = {"amount": 8.0, "frequency": 1000.0, "damping_ratio": 0.03}


def test_a_form_that_was_estimated_closes_much_of_what_the_true_one_does_where_it_is_not_from():
    runs = tuple(run(at(v), ("beam_modes", BEAMS), seed=40 + i) for i, v in enumerate(SPEEDS))
    comparison = CaseComparison(RIG, runs, EFFECTS, None, (), np.empty(0))
    left = []
    for form in estimated_forms(comparison, [0, 2]):
        comparison.forms["beam_modes", form.forms[0]] = form
        spec = LawSpec("beam_modes", {"form": form.forms[0], "amount": 1.0})
        left.append(float(comparison.misfits(Model(effects=(spec,)), [1])[0]))
    truth = Model(effects=(LawSpec("beam_modes", BEAMS),))
    before, after = (float(comparison.misfits(model, [1])[0]) for model in (Model(), truth))
    assert before > after
    assert before - min(left) > 0.5 * (before - after)


def test_a_transfer_is_found_beneath_noise_and_not_where_there_was_nothing():
    rng, rate = np.random.default_rng(0), 8e3
    spectrum = np.fft.rfft(rng.standard_normal(16000))
    x = np.fft.irfft(spectrum * _low_pass().at(np.fft.rfftfreq(16000, 1.0 / rate)))
    r = 0.5 * np.roll(x, 8)
    pairs = [(x, r + 0.02 * rng.standard_normal(x.size))]
    found = wiener_estimate(pairs, rate, 0.02, noise=lambda f: [np.full(f.size, 0.02**2)])
    assert abs(found.at(np.array([300.0]))[0]) == pytest.approx(0.5, rel=0.1)
    assert abs(found.at(np.array([3000.0]))[0]) < 0.2


def _low_pass():
    frequency = np.linspace(0.0, 4e3, 401)
    return TransferFunction(frequency, (frequency < 1000.0).astype(complex))
