"""What the classifier learns from, and that learning repeats itself."""

from dataclasses import replace

import numpy as np
import pytest

from models.errors import ParameterError
from noise.classifier import LABELS, load_classifier
from noise.classifier.model import has_more_than_sound
from noise.labels.windows import FEATURE_NAMES
from noise.training.classifier import cross_fitting
from noise.training.classifier.cross_fitting import N_FOLDS, parts
from noise.training.classifier.fit import learn, load_real_sounds, train
from noise.training.classifier.own_recordings import OWN_WEIGHT
from noise.training.classifier.samples import Sample, draw_sample


def columns(classifier, sample):
    return sample.features[:, [FEATURE_NAMES.index(name) for name in classifier.feature_names]]


@pytest.fixture(scope="module")
def samples():
    return [draw_sample(seed) for seed in np.random.SeedSequence(6).spawn(48)]


def learn_quickly(samples, **options):
    """Learn in fewer rounds: what is asked here does not depend on how many there are."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cross_fitting, "_N_ROUNDS", 40)
        return learn(samples, **options)


@pytest.fixture(scope="module")
def small(samples):
    return learn_quickly(samples, seed=3)


def test_no_bushing_is_simulated_for_what_is_made_up(samples):
    drawn = [draw_sample(s, bushings=False) for s in np.random.SeedSequence(7).spawn(12)]
    assert not any(has_more_than_sound(s.features, FEATURE_NAMES).any() for s in drawn)
    assert any(has_more_than_sound(s.features, FEATURE_NAMES).any() for s in samples)


def test_samples_whose_name_hangs_on_a_bound_are_neither_learned_nor_scored(small, samples):
    clear = [i for i, sample in enumerate(samples) if not sample.ambiguous]
    unclear = [replace(s, ambiguous=s.ambiguous or i in clear[:3]) for i, s in enumerate(samples)]
    fewer = learn_quickly(unclear, seed=3)
    for card, n in ((small.card, len(clear)), (fewer.card, len(clear) - 3)):
        assert sum(card["samples"].values()) == card["pressure_kinds_left_out"]["n"] == n
        assert card["three_channels_kinds_left_out"]["n"] < n


def test_too_few_samples_to_know_every_label_are_refused():
    with pytest.raises(ParameterError, match="draw more"):
        train(seed=0, n_training=6)


def test_every_label_occurs_among_the_samples(samples):
    assert {sample.label for sample in samples} == set(LABELS)


def test_own_samples_are_learned_beside_the_others_and_scored(samples):
    labels = [label for label in LABELS if label != "squawk"]
    own = [
        Sample(sample.features[:, ::-1].copy(), "squawk", f"{i}.wav", OWN_WEIGHT, real=True)
        for i, sample in enumerate(s for s in samples if s.label in labels)
    ]
    said = learn_quickly(samples, seed=3, added=own).card["own"]
    squawk = said["labels"]["squawk"]
    assert said["files"] == squawk["files"] == len(own)
    assert squawk["recall"] > 0.8


def test_what_is_scored_was_not_learned_by_what_scores_it():
    sounds = [Sample(np.zeros((2, 3), np.float32), "creak", f"{i // 3}") for i in range(30)]
    part = parts(sounds, seed=1)
    assert set(part.tolist()) == set(range(N_FOLDS))
    assert all(len({part[3 * i + j] for j in range(3)}) == 1 for i in range(10))


def test_real_sounds_are_free_to_learn_from_and_say_whose_they_are():
    real, licences = load_real_sounds()
    assert sum(not sample.varied for sample in real) > 200
    assert {s.label for s in real if s.varied} == {"creak", "squawk", "squeal"}
    assert {s.source for s in real} == set(licences)
    free = ("CC0", "CC BY 3", "CC BY 4", "CC-BY ", "MIT", "skid.ogg CC BY 3")
    assert all(licence.startswith(free) for licence in licences.values())


@pytest.mark.slow
def test_the_shipped_classifier_is_what_training_with_seed_0_gives():
    shipped, again = load_classifier(), train(seed=0)
    samples = [draw_sample(seed) for seed in np.random.SeedSequence(9).spawn(20)]
    features = np.concatenate([columns(shipped, sample) for sample in samples])
    assert again.predict_proba(features).tobytes() == shipped.predict_proba(features).tobytes()
    for key in ("samples", "false_names", "real_sources_left_out"):
        assert again.card[key] == shipped.card[key]
