"""Model files: what is written comes back, and what is no model of the kind is refused."""

from __future__ import annotations

from contextlib import suppress
from itertools import pairwise

import numpy as np
import pytest

from models.errors import ParameterError
from noise.base.model_file import ModelKind, load_model, save_model
from noise.base.trees import BoostedTrees
from noise.classifier import load_classifier
from noise.diagnosis.causes.posterior import load_posterior
from noise.inference import load_inference

MEAN = ModelKind("mean", 2, "make-mean --out", ("", ""))
LOADERS = [load_classifier, load_inference, load_posterior]


def build(header, arrays):
    return header["unit"], arrays["value"]


@pytest.fixture
def path(tmp_path):
    save_model(tmp_path / "mean.npz", MEAN, {"unit": "Nm"}, {"value": np.arange(3.0)})
    return tmp_path / "mean.npz"


def refusal(path, kind=MEAN):
    with pytest.raises(ParameterError) as refused:
        load_model(path, kind, build)
    assert "\n" not in str(refused.value)
    return str(refused.value)


def test_a_model_of_another_kind_is_named(path):
    said = refusal(path, MEAN._replace(name="median"))
    assert said == f"median {path}: is a mean, expected a median"


def test_a_file_of_an_older_form_says_how_to_make_it_again(path):
    said = refusal(path, MEAN._replace(version=3))
    assert said == (
        f"mean {path}: of format 2, expected 3; make it again with `make-mean --out mean.npz`"
    )


def test_a_file_with_any_byte_changed_is_refused_or_read(path):
    whole = path.read_bytes()
    for at in range(len(whole)):
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 0xFF]) + whole[at + 1 :])
        with suppress(ParameterError):
            load_model(path, MEAN, build)


@pytest.mark.parametrize(("load", "other"), [*pairwise(LOADERS), (LOADERS[-1], LOADERS[0])])
def test_shipped_models_are_not_taken_for_one_another(load, other, tmp_path):
    load().save(tmp_path / "model.npz")
    assert type(load(tmp_path / "model.npz")) is type(load())
    with pytest.raises(ParameterError, match="expected a"):
        other(tmp_path / "model.npz")


def stump(**other):
    arrays = {
        "roots": np.zeros(1, dtype=np.int32),
        "feature": np.array([0, -1, -1], dtype=np.int16),
        "threshold": np.array([0.5, 0.0, 0.0]),
        "children": np.array([[1, 2], [0, 0], [0, 0]], dtype=np.int32),
        "missing_left": np.array([True, False, False]),
        "classes": np.zeros(1, dtype=np.int16),
        "value": np.array([0.0, -1.0, 1.0]),
        "base": np.zeros(1),
    }
    return BoostedTrees(**{**arrays, **other})


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"feature": np.array([1, -1, -1], dtype=np.int16)}, "features"),
        ({"feature": np.array([0, -2, -1], dtype=np.int16)}, "do not end"),
        ({"feature": np.array([0.0, -1.0, -1.0])}, "whole numbers"),
        ({"roots": np.array([3], dtype=np.int32)}, "do not end"),
        ({"roots": np.zeros(0, dtype=np.int32)}, "fit together"),
        ({"children": np.zeros((3, 2), dtype=np.int32)}, "do not end"),
        ({"threshold": np.zeros(2)}, "fit together"),
        ({"classes": np.ones(1, dtype=np.int16)}, "classes"),
        ({"value": np.array([0.0, np.nan, 1.0])}, "no numbers"),
    ],
)
def test_trees_that_cannot_be_evaluated_are_refused(changed, said):
    with pytest.raises(ValueError, match=said):
        stump(**changed).check(1)


def test_scores_do_not_depend_on_how_many_rows_there_are():
    classifier = load_classifier()
    trees = classifier.trees
    x = np.random.default_rng(0).normal(size=(3000, len(classifier.feature_names)))
    assert np.array_equal(trees.scores(x)[2990:], trees.scores(x[2990:]))
