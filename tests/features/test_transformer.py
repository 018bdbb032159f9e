from __future__ import annotations

import numpy as np
import pytest
from sklearn.utils.estimator_checks import parametrize_with_checks

from features import RecordingFeatures, feature_names, feature_vector
from models.errors import ParameterError

RATE = 16_000.0
T = np.arange(3200) / RATE


def hiss(seed=0, n=3200):
    return np.random.default_rng(seed).normal(size=n)


@parametrize_with_checks([RecordingFeatures(), RecordingFeatures(("torque",), rate=2e3)])
def test_scikit_learn_accepts_it(estimator, check):
    check(estimator)


def test_a_row_is_the_feature_vector_of_the_waveform():
    X = np.stack([hiss(), np.sin(6000 * T)])
    transformer = RecordingFeatures(("acceleration",), rate=RATE, calibrated=True).fit(X)
    expected = [list(feature_vector(x, RATE, "acceleration").values()) for x in X]
    np.testing.assert_array_equal(transformer.transform(X), expected)
    names = [f"acceleration_{name}" for name in feature_names("acceleration")]
    assert transformer.get_feature_names_out().tolist() == names


@pytest.mark.parametrize(
    ("transformer", "X", "message"),
    [
        (RecordingFeatures("pressure"), [hiss()], "kinds are 'pressure'; give a tuple"),
        (RecordingFeatures(("pressure", "torque")), [hiss()], "waveforms are of one kind"),
    ],
)
def test_what_cannot_be_used_is_refused(transformer, X, message):
    with pytest.raises(ParameterError, match=message):
        transformer.fit(X).transform(X)
