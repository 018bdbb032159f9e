"""The classifier: its trees, its file, its probabilities."""

import numpy as np
import pytest
from sklearn.ensemble import HistGradientBoostingClassifier

from models.errors import ParameterError
from noise.classifier import LABELS, load_classifier
from noise.labels.segmentation import QUIET, labelled_stretches
from noise.training.classifier.cross_fitting import (
    FALSE_NAMES_AN_HOUR,
    false_names,
    fit_calibration,
    fit_thresholds,
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


def test_calibrated_probabilities_are_as_often_right_as_they_say():
    rng = np.random.default_rng(2)
    # Votes that are more certain than they have reason to be.
    honest = rng.dirichlet(np.ones(5), 4000)
    y = np.array([rng.choice(5, p=p) for p in honest])
    votes = honest**3 / (honest**3).sum(axis=1, keepdims=True)
    fitted = fit_calibration(votes[:2000], np.arange(2000), y[:2000])
    assert fitted.sharpness < 0.6
    p = fitted(votes[2000:])
    right = y[2000:] == p.argmax(axis=1)
    assert right.mean() == pytest.approx(p.max(axis=1).mean(), abs=0.03)


def test_few_backgrounds_are_called_each_noise_at_its_threshold():
    rng = np.random.default_rng(3)
    backgrounds = [np.tile(rng.dirichlet((0.4, 0.4, 0.4, 0.5, 0.5)), (40, 1)) for _ in range(125)]
    thresholds = np.array(fit_thresholds(backgrounds))
    assert np.all((thresholds > 0.25) & (thresholds < 0.97))
    assert np.all(false_names(backgrounds, thresholds) <= FALSE_NAMES_AN_HOUR)
    assert np.all(false_names(backgrounds, thresholds - 0.02) > FALSE_NAMES_AN_HOUR)


def test_what_a_sound_fades_into_does_not_name_it():
    rooster, echo = [0.1, 0.0, 0.2, 0.0, 0.7], [0.0, 0.0, 0.9, 0.0, 0.1]
    p = np.array([rooster] * 7 + [echo])
    level = np.array([-20.0] * 7 + [-20.0 - QUIET])
    for below, name, p_squeal in ((0.0, "squeal", 0.55), (1.0, "unknown", 0.2)):
        level[-1] -= below
        _, names, heard = labelled_stretches(p, [0.5] * 3, level)
        assert [LABELS[name] for name in names] == [name]
        assert heard[0, 2] == pytest.approx(p_squeal)


def test_what_sounds_all_through_a_recording_is_no_name_of_a_part_of_it():
    other, hardly, clearly = ([p, 0.0, 0.0, 0.0, 1.0 - p] for p in (0.4, 0.6, 0.9))
    for louder, name in ((hardly, "unknown"), (clearly, "creak")):
        p = np.array([other] * 8 + [louder] * 8)
        _, names, _ = labelled_stretches(p, [0.5] * 3)
        assert LABELS[names[-1]] == name


def test_a_window_half_in_a_noise_does_not_name_the_silence_beside_it():
    none, half, creak = (np.eye(5)[[3]], [[0.0, 0.0, 0.0, 0.3, 0.7]], np.eye(5)[[0]])
    p = np.concatenate([none, none, none, half, creak, creak, creak, creak])
    _, names, heard = labelled_stretches(p, [0.5] * 3)
    assert [LABELS[name] for name in names] == ["none", "creak"]
    assert heard[0, 3] == 1.0


@pytest.mark.parametrize("content", [b"", b"no zip", b"PK\x03\x04garbage"])
def test_a_file_that_is_no_classifier_is_refused_in_one_line(tmp_path, content):
    path = tmp_path / "model.npz"
    path.write_bytes(content)
    with pytest.raises(ParameterError, match=r"model\.npz") as refused:
        load_classifier(path)
    assert "\n" not in str(refused.value)


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
