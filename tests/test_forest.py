"""A forest as arrays says what scikit-learn says."""

import numpy as np
import pytest
from sklearn.ensemble import RandomForestClassifier

from noise.forest import as_arrays


@pytest.fixture(scope="module")
def data():
    rng = np.random.default_rng(0)
    y = rng.integers(0, 3, 300)
    x = rng.normal(size=(300, 4)) + y[:, None] * np.array([1.0, 0.5, 0.0, 2.0])
    x[rng.random(x.shape) < 0.1] = np.nan
    return x, y


def fitted(x, y):
    model = RandomForestClassifier(n_estimators=40, min_samples_leaf=3, random_state=5)
    return model.fit(x, y)


def test_a_forest_as_arrays_votes_as_scikit_learn_does(data):
    x, y = data
    original = fitted(x, y)
    assert as_arrays(original).probabilities(x) == pytest.approx(
        original.predict_proba(x), abs=1e-6
    )


def test_of_several_yes_or_no_outputs_the_votes_are_the_shares_of_yes(data):
    x, y = data
    original = fitted(x, np.stack([y == 0, y > 1], axis=1))
    yes = np.stack([p[:, 1] for p in original.predict_proba(x)], axis=1)
    assert as_arrays(original).probabilities(x) == pytest.approx(yes, abs=1e-6)


def test_trees_that_never_end_are_refused(data):
    forest = as_arrays(fitted(*data))
    forest.check()
    forest.children[:] = 0
    with pytest.raises(ValueError, match="do not end"):
        forest.check()
