"""The classifier: its trees, its file, its probabilities."""

import numpy as np
import pytest
from sklearn.ensemble import HistGradientBoostingClassifier

from models.errors import ParameterError
from noise.classifier import LABELS, load_classifier
from noise.classifier.model import Calibration
from noise.training.classifier.operating_point import (
    FALSE_NAMES,
    file_name,
    fit_calibration,
    means_of_groups,
)
from noise.training.trees import grow_boosted_trees


@pytest.fixture(scope="module")
def data():
    rng = np.random.default_rng(0)
    y = rng.integers(0, 3, 300)
    x = rng.normal(size=(300, 4)) + y[:, None] * np.array([1.0, 0.5, 0.0, 2.0])
    x[rng.random(x.shape) < 0.1] = np.nan
    return x, y


def test_trees_as_arrays_say_what_scikit_learn_says(data):
    x, y = data
    weight = np.random.default_rng(1).uniform(0.5, 2.0, y.size)
    trees = grow_boosted_trees(x, y, weight=weight, n_rounds=20, seed=5)
    original = HistGradientBoostingClassifier(
        max_iter=20,
        learning_rate=0.1,
        max_leaf_nodes=16,
        min_samples_leaf=10,
        l2_regularization=1.0,
        max_features=0.3,
        early_stopping=False,
        random_state=5,
    ).fit(x, y, sample_weight=weight)
    assert trees.probabilities(x) == pytest.approx(original.predict_proba(x), abs=1e-9)


def test_a_saved_classifier_gives_the_same_bytes_of_probabilities(tmp_path):
    shipped = load_classifier()
    shipped.save(tmp_path / "copy.npz")
    n = len(shipped.feature_names)
    features = np.stack([0.1 * np.arange(n), np.full(n, np.nan)]).astype(np.float32)
    again = load_classifier(tmp_path / "copy.npz").predict_proba(features)
    assert again.tobytes() == shipped.predict_proba(features).tobytes()


def test_probabilities_sum_to_one_whatever_is_missing():
    classifier = load_classifier()
    n = len(classifier.feature_names)
    features = np.stack([np.full(n, np.nan), np.full(n, np.inf)]).astype(np.float32)
    p = classifier.predict_proba(features)
    assert p.shape == (2, len(LABELS))
    assert p.sum(axis=1) == pytest.approx([1.0, 1.0])


def test_a_calibration_of_even_weights_moves_no_vote_past_another():
    votes = np.random.default_rng(1).dirichlet(np.ones(5), 50)
    calibrated = Calibration(2.5, (1.0,) * 5)(votes)
    assert np.array_equal(calibrated.argmax(axis=1), votes.argmax(axis=1))


def test_calibrated_probabilities_are_as_often_right_as_they_say():
    rng = np.random.default_rng(2)
    # Votes that are more certain than they have reason to be.
    honest = rng.dirichlet(np.ones(5), 4000)
    y = np.array([rng.choice(5, p=p) for p in honest])
    votes = honest**3 / (honest**3).sum(axis=1, keepdims=True)
    fitted = fit_calibration(votes[:2000], np.arange(2000), y[:2000], unknown=9)
    assert fitted.sharpness < 0.6
    p = fitted(votes[2000:])
    right = y[2000:] == p.argmax(axis=1)
    assert right.mean() == pytest.approx(p.max(axis=1).mean(), abs=0.03)


def test_few_background_sounds_are_called_a_noise_after_calibration():
    rng = np.random.default_rng(3)
    y = rng.integers(0, 5, 1000)
    votes = rng.dirichlet(np.ones(5), 1000) + 0.4 * np.eye(5)[y]
    votes /= votes.sum(axis=1, keepdims=True)
    found = fit_calibration(votes, np.arange(1000), y, 4)(votes)[y == 4].argmax(axis=1)
    assert np.mean(found < 3) <= FALSE_NAMES


def test_a_file_is_named_by_its_longest_segment_that_is_not_none():
    creak, squeal, none = np.eye(5)[[0, 2, 3]]
    assert file_name(np.stack([none] * 20 + [creak] * 4 + [none] * 9 + [squeal] * 6), none=3) == 2
    assert file_name(np.stack([none] * 4), none=3) == 3


def test_a_recording_is_the_mean_of_its_windows():
    p = np.array([[0.0, 1.0], [1.0, 0.0], [1.0, 0.0]])
    assert means_of_groups(p, np.array([0, 0, 1])).tolist() == [[0.5, 0.5], [1.0, 0.0]]


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
    children = shipped.trees.children.copy()
    try:
        shipped.trees.children[:] = 0
        shipped.save(tmp_path / "loop.npz")
    finally:
        shipped.trees.children[:] = children
    with pytest.raises(ParameterError, match="do not end"):
        load_classifier(tmp_path / "loop.npz")
