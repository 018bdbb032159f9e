from __future__ import annotations

import math
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import features
from features.table import (
    FEATURES,
    KINDS,
    feature_names,
    feature_vector,
    recording_feature_names,
    recording_features,
)
from models.errors import ParameterError
from models.recording import Channel, Recording


def noise(n, seed=0):
    return np.random.default_rng(seed).normal(size=n)


# --- the table -------------------------------------------------------------------------------


@pytest.mark.parametrize("feature", FEATURES, ids=lambda f: f"{f.kinds[0]}-{f.name}")
def test_every_feature_says_what_it_is(feature):
    assert feature.definition.endswith(".")
    assert "\n" not in feature.definition
    assert feature.unit
    assert feature.source
    assert set(feature.kinds) <= set(KINDS)
    assert feature.calibrated == (
        feature.unit in ("N m", "N m/s")
        or feature.name in ("level", "level_a")
        or feature.name.startswith("third_octave_")
    )


def test_every_public_name_is_there_and_importing_the_package_is_light():
    assert all(hasattr(features, name) for name in features.__all__)
    code = "import sys, features; assert 'scipy' not in sys.modules and 'numpy' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)


# --- what must not break them -----------------------------------------------------------------


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "signal",
    [np.zeros(960), np.full(4800, 0.1), np.full(4800, 3.0) + 1e-12, np.full(16, -2.0)],
    ids=["zeros", "constant", "rounding", "short"],
)
def test_silence_is_finite_or_undefined_and_never_warns(kind, signal):
    values = feature_vector(signal, 48e3, kind)
    assert not any(math.isinf(value) for value in values.values())
    assert values["line_count"] == 0.0
    assert values["harmonicity"] == 0.0


@pytest.mark.filterwarnings("error")
@settings(max_examples=60)
@given(
    n=st.integers(16, 3000),
    seed=st.integers(0, 2**16),
    shape=st.sampled_from(["clicks", "step", "ramp", "walk", "clipped", "tiny", "huge"]),
    kind=st.sampled_from(KINDS),
    rate=st.sampled_from([200.0, 2e3, 16e3, 48e3, 65_536.0]),
)
def test_no_signal_raises_or_warns(n, seed, shape, kind, rate):
    rng = np.random.default_rng(seed)
    x = rng.normal(size=n)
    signal = {
        "clicks": np.where(x > 2.5, x, 0.0),
        "step": np.where(np.arange(n) < rng.integers(n), 0.0, 1.0),
        "ramp": np.arange(n) * 1e-3,
        "walk": np.cumsum(x),
        "clipped": np.clip(10 * np.sin(np.arange(n) * rng.uniform(0, 3)), -1, 1),
        "tiny": 1e-100 * x,
        "huge": 1e100 * x,
    }[shape]
    values = feature_vector(signal, rate, kind)
    assert not any(math.isinf(value) for value in values.values())
    for name in ("line_share", "harmonicity", "periodicity"):
        assert 0.0 <= values[name] <= 1.0


# --- recordings -------------------------------------------------------------------------------


def test_a_recording_gives_the_first_channel_of_each_kind():
    x = np.stack([noise(4800, 1), noise(4800, 2), noise(4800, 3)])
    channels = (Channel("acceleration_2"), Channel("pressure"), Channel("acceleration"))
    found = recording_features(Recording(x, 48e3, channels))
    assert tuple(found) == recording_feature_names()
    assert found["acceleration_level"] == feature_vector(x[0], 48e3, "acceleration")["level"]
    assert found["pressure_level"] == feature_vector(x[1], 48e3, "pressure")["level"]
    assert all(math.isnan(found[f"torque_{name}"]) for name in feature_names("torque"))


def test_an_error_names_recording_and_channel():
    x = np.full((1, 4800), np.nan)
    with pytest.raises(ParameterError, match=r"'run07\.wav', channel 'pressure': signal: sample 0"):
        recording_features(Recording(x, 48e3, (Channel("pressure"),), name="run07.wav"))
