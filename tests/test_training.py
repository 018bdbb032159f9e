"""What the classifier learns from, and that learning repeats itself."""

import numpy as np
import pytest

from models.errors import ParameterError
from noise.classifier import LABELS, load_classifier
from noise.classifier.designs import random_design
from noise.classifier.hearing import as_recorded, coloured_noise, resampled
from noise.classifier.strangers import RECIPES
from noise.classifier.training import draw_sample, train


@pytest.fixture(scope="module")
def small():
    return train(seed=3, n_training=70, n_calibration=10, n_test=10)


def test_the_same_seed_gives_the_same_bytes_of_predictions(small):
    again = train(seed=3, n_training=70, n_calibration=10, n_test=10)
    features = [draw_sample(np.random.SeedSequence(8)).features]
    assert small.predict_proba(features).tobytes() == again.predict_proba(features).tobytes()
    assert small.card == again.card


def test_the_card_tells_what_was_learned_and_scores_what_was_not(small):
    assert sum(small.card["samples"].values()) == 70
    assert small.card["test"]["n"] == 10


def test_too_few_samples_to_know_every_label_are_refused():
    with pytest.raises(ParameterError, match="draw more"):
        train(seed=0, n_training=6, n_calibration=1, n_test=1)


def test_every_label_occurs_among_the_samples():
    seeds = np.random.SeedSequence(4).spawn(60)
    assert {draw_sample(seed).label for seed in seeds} == set(LABELS)


def test_designs_differ_and_can_be_drawn_again():
    first, again, other = (random_design(np.random.default_rng(s)) for s in (1, 1, 2))
    assert first == again
    assert first != other


@pytest.mark.parametrize("recipe", RECIPES)
@pytest.mark.parametrize("rate", [16_000, 48_000])
def test_every_stranger_is_a_sound(recipe, rate):
    for seed in range(5):
        sound = recipe(rate // 2, float(rate), np.random.default_rng(seed))
        assert sound.shape == (rate // 2,)
        assert np.isfinite(sound).all()
        assert sound.std() > 0.0


def test_coloured_noise_falls_as_its_slope_says():
    noise = coloured_noise(2**16, 2.0, np.random.default_rng(0))
    power = np.abs(np.fft.rfft(noise)) ** 2
    fall = 10 * np.log10(power[100:200].mean() / power[1000:2000].mean())
    assert fall == pytest.approx(20.0, abs=1.5)


def test_a_recorded_silence_is_noise_of_unit_strength():
    heard = as_recorded(np.zeros(4800), 48e3, np.random.default_rng(0))
    assert heard.std() == pytest.approx(1.0)


def test_resampling_keeps_a_tone():
    time = np.arange(96_000) / 96e3
    tone = resampled(np.sin(2 * np.pi * 440.0 * time), 96_000, 22_050)
    assert tone.size == 22_050
    assert np.abs(np.fft.rfft(tone)).argmax() == 440


@pytest.mark.slow
def test_the_shipped_classifier_is_what_training_with_seed_0_gives():
    shipped, again = load_classifier(), train(seed=0)
    features = [draw_sample(seed).features for seed in np.random.SeedSequence(9).spawn(20)]
    assert again.predict_proba(features).tobytes() == shipped.predict_proba(features).tobytes()
    assert again.card == shipped.card
