"""Force cycles of a pulled slider, their reader, and the term that a set of records asks for."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.io import savemat

from models.errors import ParameterError, RecordingError
from models.recording import Channel, Recording
from tests.studies.pulled_slider import (
    FEATURES,
    SLIDER_TERMS,
    PulledRecord,
    Slider,
    compare_slider,
    cycle_features,
    read_pulled_record,
)

PLAIN = Slider(0.3, 0.4, 0.3)
RATE = 2000.0
RIVALS = [
    term for term in SLIDER_TERMS if term.name in ("static_ageing", "inertia", "surface_scatter")
]


def features(slider, stiffness, pull, seconds=20.0):
    force = slider.force(stiffness, pull, RATE, int(seconds * RATE))
    found = cycle_features(force[len(force) // 10 :], RATE, 0.02)
    return dict(zip(FEATURES, found, strict=True))


def written(folder, name="k168Nm_v42.mat", **series):
    path = folder / name
    savemat(path, series or {"t": np.arange(100) / RATE, "Fnorm": np.full(100, 0.3)})
    return path


def test_a_slow_slider_drops_by_twice_the_difference_of_the_coefficients():
    found = features(PLAIN, 168.0, 1e-4)
    assert np.exp(found["drop"]) == pytest.approx(0.2, rel=0.02)
    assert found["level"] == pytest.approx(0.3, abs=0.01)


def test_the_period_of_a_slow_slider_is_the_drop_over_the_rate_of_loading():
    found = features(PLAIN, 168.0, 1e-4)
    slip = np.pi * np.sqrt(0.3 / 9.81 / 168.0)
    assert np.exp(found["period"]) == pytest.approx(0.2 * 0.3 / 168.0 / 1e-4 + slip, rel=0.02)


def test_a_fast_slider_oscillates_nearly_harmonically():
    assert features(PLAIN, 168.0, 1e-4)["rise_share"] > 0.9
    fast = features(PLAIN, 168.0, 0.05, 5.0)
    assert 0.45 < fast["rise_share"] < 0.6
    inertial = 2.0 * np.pi * np.sqrt(0.3 / 9.81 / 168.0)
    assert np.exp(fast["period"]) == pytest.approx(inertial, rel=0.05)


def test_ageing_makes_slow_drops_larger():
    aged = SLIDER_TERMS[0].put(PLAIN, (0.02, 0.01))
    slow, fast = (features(aged, 168.0, pull, 120.0)["drop"] for pull in (1e-4, 1e-3))
    assert slow > fast + 0.2
    slow, fast = (features(PLAIN, 168.0, pull)["drop"] for pull in (1e-4, 1e-3))
    assert slow == pytest.approx(fast, abs=0.05)


def test_without_a_difference_of_the_coefficients_it_slides():
    found = features(Slider(0.3, 0.3, 0.3), 168.0, 1e-3)
    assert np.isnan(found["period"])
    assert found["level"] == pytest.approx(0.3, abs=0.01)


def test_scatter_of_the_surface_scatters_the_drops():
    rough = Slider(0.3, 0.4, 0.3, scatter=0.02)
    assert features(PLAIN, 168.0, 1e-3)["drop_scatter"] < 0.01
    assert features(rough, 168.0, 1e-3)["drop_scatter"] > 0.1


def test_a_record_is_read_with_the_setting_in_its_name(tmp_path):
    time, force = 3.0 + np.arange(100) / RATE, np.linspace(0.2, 0.3, 100)
    record = read_pulled_record(written(tmp_path, t=time[:, None], Fnorm=force[:, None]))
    assert (record.stiffness, record.pull) == (168.0, pytest.approx(42e-6))
    assert record.recording.rate == pytest.approx(RATE)
    assert not record.recording.calibrated
    np.testing.assert_array_equal(record.recording["force"], force)


@pytest.mark.parametrize(
    ("name", "series", "message"),
    [
        ("other.mat", {}, r"other\.mat: the name must give spring and speed"),
        ("k1Nm_v1.mat", {"t": np.arange(9.0)}, "has no variable Fnorm"),
        ("k1Nm_v1.mat", {"t": np.arange(9.0), "Fnorm": np.zeros(8)}, "must be as many"),
        ("k1Nm_v1.mat", {"t": np.arange(9.0) ** 2, "Fnorm": np.zeros(9)}, "equal steps"),
        ("k1Nm_v1.mat", {"t": np.arange(9.0), "Fnorm": np.full(9, np.nan)}, "not finite"),
    ],
)
def test_a_wrong_record_is_one_line(tmp_path, name, series, message):
    with pytest.raises(RecordingError, match=message) as told:
        read_pulled_record(written(tmp_path, name, **series))
    assert "\n" not in str(told.value)


def test_a_file_that_is_no_matlab_file_is_one_line(tmp_path):
    path = tmp_path / "k1Nm_v1.mat"
    path.write_bytes(b"not a matlab file" * 20)
    with pytest.raises(RecordingError, match="no MATLAB file"):
        read_pulled_record(path)


def records(slider, seconds=8.0, seed=5):
    """Four settings, each on a surface of its own, with noise."""
    made = []
    rng = np.random.default_rng(seed)
    for i, (stiffness, pull) in enumerate(
        [(168.0, 2e-3), (168.0, 1e-2), (2000.0, 5e-4), (2000.0, 2e-3)]
    ):
        force = slider.force(stiffness, pull, RATE, int(seconds * RATE), seed=50 + i)
        force = force + 5e-4 * rng.standard_normal(len(force))
        recording = Recording(
            force[np.newaxis], RATE, (Channel("force"),), calibrated=False, name=f"run{i}"
        )
        made.append(PulledRecord(recording, stiffness, pull))
    return made


def test_three_records_are_needed():
    with pytest.raises(ParameterError, match="needs three or more"):
        compare_slider(records(PLAIN, 1.0)[:2])


def test_a_record_of_too_few_cycles_is_refused():
    with pytest.raises(ParameterError, match="too few force cycles"):
        compare_slider(records(PLAIN, 0.5))


@pytest.mark.slow
def test_records_of_the_nominal_slider_have_no_gap():
    assert compare_slider(records(PLAIN), RIVALS).verdict == "none"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("term", "values", "seconds"),
    [
        ("static_ageing", (0.06, 0.01), 16.0),
        ("surface_scatter", (0.05, 1e-4), 8.0),
        ("inertia", (2.0,), 8.0),
    ],
)
def test_the_missing_term_of_a_simulated_slider_is_named(term, values, seconds):
    with_it = next(one for one in SLIDER_TERMS if one.name == term).put(PLAIN, values)
    found = compare_slider(records(with_it, seconds), RIVALS)
    assert found.verdict.split(" + ")[0] == term
    assert found.closed_by_effect(found.terms[0]) > 0.5
