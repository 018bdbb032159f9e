from __future__ import annotations

import math
import sys

import numpy as np
import pytest

from features.sound_quality import check_available, sound_quality_of
from models.errors import ParameterError

RATE = 48000


def at_level(sound, level):
    return sound * 2e-5 * 10 ** (level / 20) / sound.std()


def tone(frequency, level, seconds=0.5):
    return at_level(np.sin(2 * np.pi * frequency * np.arange(round(seconds * RATE)) / RATE), level)


@pytest.fixture
def _library():
    pytest.importorskip("mosqito")


def test_the_missing_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "mosqito", None)
    with pytest.raises(ParameterError, match=r'pip install "bushing-noise\[sound-quality\]"'):
        check_available()


@pytest.mark.usefixtures("_library")
def test_a_kilohertz_of_40_decibels_is_one_sone():
    # ISO 532-1, 4.3: a loudness is right within 5 % or 0.1 sone.
    heard = sound_quality_of(tone(1000, 40), RATE)
    assert heard.loudness == pytest.approx(1.0, abs=0.05)
    assert heard.loudness_n5 == pytest.approx(1.0, abs=0.05)
    assert heard.loudness_n10 == pytest.approx(1.0, abs=0.05)
    assert heard.tone_frequency == pytest.approx(1000, abs=5)


@pytest.mark.slow
@pytest.mark.usefixtures("_library")
def test_a_tone_in_noise_stands_out_and_noise_alone_does_not():
    noise = at_level(np.random.default_rng(0).standard_normal(RATE // 2), 50)
    heard = sound_quality_of(noise + tone(2000, 55), RATE)
    assert heard.tone_frequency == pytest.approx(2000, abs=5)
    assert heard.tone_to_noise > 15
    assert heard.prominence > 15
    assert math.isnan(sound_quality_of(noise, RATE).tone_frequency)


@pytest.mark.parametrize(
    ("sound", "rate", "said"),
    [
        (np.zeros(4800), 48000, "0.1 s is too short"),
        (np.zeros(51200), 51200, "48000 Hz"),
        (np.full(48000, np.nan), 48000, "finite"),
    ],
)
def test_sounds_it_would_be_wrong_for_are_refused(sound, rate, said):
    with pytest.raises(ParameterError, match=said):
        sound_quality_of(sound, rate)
