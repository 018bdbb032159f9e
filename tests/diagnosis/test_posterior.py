"""The cause posterior: what it learns, how it is kept, and what it says."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given, strategies as st

from models.errors import ParameterError
from noise.diagnosis.causes.advice import equivalent_pairs, next_measurement
from noise.diagnosis.causes.posterior import CAUSES, load_posterior
from noise.diagnosis.causes.verdict import (
    joint_probabilities,
    likeliest,
    marginals,
    needs_explaining,
)
from noise.diagnosis.gap import Gap
from noise.training.causes.fit import (
    grow_cause_trees,
)
from sim.effects import EFFECTS
from tests.helpers.made_posteriors import MOVES, made_posterior, made_table


@pytest.fixture(scope="module")
def posterior():
    return made_posterior()


@pytest.mark.parametrize("cause", [*MOVES, "parameters", "unknown", "none"])
def test_a_cause_that_was_learned_is_the_most_probable(posterior, cause):
    rng = np.random.default_rng(123)
    for _ in range(5):
        p = posterior.probabilities(made_table(rng, cause))
        assert set(p) == set(CAUSES)
        assert all(0.0 <= x <= 1.0 for x in p.values())
        assert max(p, key=p.get) == cause


def test_at_most_few_cases_without_a_cause_raise_the_alarm(posterior):
    rng = np.random.default_rng(11)
    tables = [made_table(rng) for _ in range(60)]
    alarms = [needs_explaining(posterior.probabilities(t)["none"], posterior.alarm) for t in tables]
    assert np.mean(alarms) <= 0.05
    assert 0.0 < posterior.alarm <= 0.5


@pytest.mark.parametrize("kind", ["causes", "loop"])
def test_a_file_that_does_not_fit_this_version_is_refused_in_one_line(posterior, tmp_path, kind):
    path = tmp_path / "other.npz"
    posterior.save(path)
    with np.load(path) as file:
        arrays = dict(file)
    header = json.loads(str(arrays["header"]))
    if kind == "causes":
        header["causes"] = header["causes"][::-1]
    else:
        arrays["children"] = np.zeros_like(arrays["children"])
    np.savez(path, **arrays | {"header": np.array(json.dumps(header))})
    with pytest.raises(ParameterError) as refused:
        load_posterior(path)
    assert str(path) in str(refused.value)
    assert "\n" not in str(refused.value)


def test_trees_that_are_offered_all_columns_say_what_scikit_learn_says():
    from sklearn.ensemble import HistGradientBoostingClassifier

    rng = np.random.default_rng(0)
    x = rng.normal(size=(300, 8)).astype(np.float32)
    y = np.stack([x[:, 0] > 0.0, x[:, 1] + x[:, 2] > 0.5], axis=1).astype(np.int64)
    model = HistGradientBoostingClassifier(
        max_iter=12, learning_rate=0.05, max_leaf_nodes=14, min_samples_leaf=8, max_bins=63,
        l2_regularization=1.0, early_stopping=False,
    )  # fmt: skip
    expected = np.stack([model.fit(x, of).decision_function(x) for of in y.T], axis=1)
    trees = grow_cause_trees(x, y, n_rounds=12, seed=0)
    assert trees.scores(x) == pytest.approx(expected, abs=1e-6)


def _p(**given):
    return dict.fromkeys(CAUSES, 0.0) | given


@pytest.mark.parametrize(
    ("p", "verdict"),
    [
        (_p(none=0.01, clipping=0.8), ("clipping",)),
        (_p(none=0.01, clipping=0.2, beam_modes=0.1), ("clipping",)),
        (_p(none=0.01, clipping=0.7, beam_modes=0.9), ("beam_modes", "clipping")),
        (_p(none=0.01, clipping=0.7, parameters=0.9), ("parameters",)),
        (_p(none=0.01, clipping=0.7, unknown=0.71), ("unknown",)),
        (_p(none=0.01, clipping=0.9, unknown=0.71), ("clipping",)),
        (_p(none=0.9, clipping=0.1), ()),
        (
            _p(none=0.0, clipping=0.9, beam_modes=0.8, plate_modes=0.7, mains_hum=0.6),
            ("clipping", "beam_modes", "plate_modes"),
        ),
    ],
)
def test_the_verdict_is_the_likeliest_set_of_causes(p, verdict):
    assert likeliest(joint_probabilities(p)) == verdict


@given(st.dictionaries(st.sampled_from(list(EFFECTS)), st.floats(0.001, 0.999), max_size=6))
def test_causes_are_at_least_as_likely_as_any_set_that_they_are_in(p):
    joint = joint_probabilities(_p(none=0.1, unknown=0.1, parameters=0.1, **p))
    assert sum(joint.values()) == pytest.approx(1.0)
    single = marginals(joint)
    for causes, chance in joint.items():
        assert all(single[name] >= chance - 1e-12 for name in causes)


def test_something_is_to_be_explained_where_nothing_is_unlikely_to_be_the_matter():
    assert not needs_explaining(0.05, 0.05)
    assert needs_explaining(0.049, 0.05)
    large, common = (
        Gap(6.0, 0.001, np.ones(1), np.ones((1, 3))),
        Gap(6.0, 0.4, np.ones(1), np.ones((1, 3))),
    )
    assert needs_explaining(0.9, 0.05, large)
    assert not needs_explaining(0.9, 0.05, common)


def test_two_causes_as_probable_as_each_other_are_declared_alike():
    p = _p(static_ageing=0.45, critical_torque_scatter=0.4, clipping=0.01)
    ranked = sorted(p, key=lambda n: -p[n])
    ranked = [n for n in ranked if n in EFFECTS]
    assert equivalent_pairs(ranked, p, {"torque"}) == (
        ("critical_torque_scatter", "static_ageing"),
    )
    sure = _p(static_ageing=0.95, critical_torque_scatter=0.9)  # a pair, both at work
    ranked = sorted((n for n in sure if n in EFFECTS), key=lambda n: -sure[n])
    assert equivalent_pairs(ranked, sure, {"torque"}) == ()
    one = _p(static_ageing=0.95, critical_torque_scatter=0.1)
    ranked = sorted((n for n in one if n in EFFECTS), key=lambda n: -one[n])
    assert equivalent_pairs(ranked, one, {"torque"}) == ()


ALL = {"torque", "acceleration", "pressure", "angle"}


def test_the_next_measurement_is_the_channel_that_is_missing_or_what_tells_two_causes_apart():
    p = _p(none=0.01, velocity_weakening=0.5, frictional_heating=0.4)
    assert next_measurement((), _p(none=1.0), ALL) == ""
    assert "2.wav once more" in next_measurement((), _p(none=1.0), ALL, farthest="2.wav")
    off = next_measurement(("parameters",), _p(parameters=0.9), ALL, own_fit=False)
    assert "identify" in off
    assert "torque" in next_measurement(("velocity_weakening",), p, {"pressure"})
    assert "angle" in next_measurement(("velocity_weakening",), p, ALL - {"angle"})
    assert "from cold" in next_measurement(("velocity_weakening",), p, ALL)
    assert "three speeds" in next_measurement(("unknown",), _p(unknown=0.99), ALL)
    said = {next_measurement(("clipping",), _p(clipping=x), ALL) for x in (0.5, 0.99)}
    assert len(said) == 2
