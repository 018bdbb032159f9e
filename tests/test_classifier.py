"""The classifier: its forest, its file, its probabilities."""

import numpy as np
import pytest
from sklearn.ensemble import RandomForestClassifier

from models.errors import ParameterError
from noise.classifier import LABELS, load_classifier
from noise.classifier.forest import grow_forest
from noise.classifier.model import calibrated


@pytest.fixture(scope="module")
def data():
    rng = np.random.default_rng(0)
    y = rng.integers(0, 3, 300)
    x = rng.normal(size=(300, 4)) + y[:, None] * np.array([1.0, 0.5, 0.0, 2.0])
    x[rng.random(x.shape) < 0.1] = np.nan
    return x, y


def test_a_forest_as_arrays_votes_as_scikit_learn_does(data):
    x, y = data
    forest = grow_forest(x, y, n_trees=40, least_leaf=3, seed=5)
    original = RandomForestClassifier(
        n_estimators=40, min_samples_leaf=3, class_weight="balanced", random_state=5
    ).fit(x, y)
    assert forest.probabilities(x) == pytest.approx(original.predict_proba(x), abs=1e-6)


def test_a_saved_classifier_gives_the_same_bytes_of_probabilities(tmp_path):
    shipped = load_classifier()
    shipped.save(tmp_path / "copy.npz")
    features = [{name: 0.1 * i for i, name in enumerate(shipped.feature_names)}, {}]
    again = load_classifier(tmp_path / "copy.npz").predict_proba(features)
    assert again.tobytes() == shipped.predict_proba(features).tobytes()


def test_probabilities_sum_to_one_whatever_is_missing():
    classifier = load_classifier()
    p = classifier.predict_proba([{}, dict.fromkeys(classifier.feature_names, np.inf)])
    assert p.shape == (2, len(LABELS))
    assert p.sum(axis=1) == pytest.approx([1.0, 1.0])


def test_sharpness_moves_no_vote_past_another():
    votes = np.random.default_rng(1).dirichlet(np.ones(5), 50)
    assert np.array_equal(calibrated(votes, 2.5).argmax(axis=1), votes.argmax(axis=1))


@pytest.mark.parametrize("content", [b"", b"no zip", b"PK\x03\x04garbage"])
def test_a_file_that_is_no_classifier_is_refused_in_one_line(tmp_path, content):
    path = tmp_path / "model.npz"
    path.write_bytes(content)
    with pytest.raises(ParameterError, match=r"model\.npz") as refused:
        load_classifier(path)
    assert "\n" not in str(refused.value)


def test_a_classifier_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(ParameterError, match="no such file"):
        load_classifier(tmp_path / "nothing.npz")


def test_trees_that_never_end_are_refused(tmp_path):
    shipped = load_classifier()
    shipped.forest.children.setflags(write=True)
    children = shipped.forest.children.copy()
    try:
        shipped.forest.children[:] = 0
        shipped.save(tmp_path / "loop.npz")
    finally:
        shipped.forest.children[:] = children
    with pytest.raises(ParameterError, match="do not end"):
        load_classifier(tmp_path / "loop.npz")
