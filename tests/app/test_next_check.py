"""Which recording is checked next: one that is likely wrong, and unlike those asked before."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest

from models.recording import Channel, Recording
from noise.app.labels.next_check import NextCheck
from noise.app.labels.segment_features import SegmentFeatures, mean_features
from noise.batch import Job
from noise.labels.windows import FEATURE_NAMES
from noise.recordings import write_recording
from tests.helpers.labelled_folder import made_row
from tests.helpers.opened_app import PATIENCE

JOBS = [Job(number, Path(f"{number}.wav"), f"{number}.wav") for number in range(9)]


def one(p_creak, p_squeal, source="classifier", **more):
    shares = {"p_creak": p_creak, "p_squawk": 0.0, "p_squeal": p_squeal, "p_none": 0.0}
    shares["p_unknown"] = 1.0 - p_creak - p_squeal
    return [made_row("x.wav", "creak", label_source=source, frequency_hz=100.0, **shares, **more)]


def order(recordings, jobs=JOBS, describing=None):
    check, found = NextCheck(jobs, describing), [None]
    while (index := check.next(recordings, found[-1])["id"]) is not None:
        found.append(index)
    return found[1:]


def test_the_least_sure_comes_first_and_each_comes_once():
    recordings = [one(0.9, 0.1), one(0.5, 0.5), one(0.7, 0.3)]
    assert order(recordings)[0] == 1
    assert sorted(order(recordings)) == [0, 1, 2]


def test_what_is_unlike_those_before_comes_before_what_is_like_them():
    alike, unlike = one(0.5, 0.49), one(0.6, 0.0)
    assert order([one(0.5, 0.5), alike, unlike]) == [0, 2, 1]


def test_what_a_person_has_said_is_not_asked():
    assert order([one(0.5, 0.5, "human"), one(0.9, 0.1)]) == [1]


def test_what_was_looked_at_does_not_come_again():
    check, recordings = NextCheck(JOBS), [one(0.5, 0.5), one(0.9, 0.1)]
    assert check.next(recordings, 0)["id"] == 1
    assert check.next(recordings, 1) == {"id": None}


def test_what_was_told_but_not_looked_at_is_told_again():
    check, recordings = NextCheck(JOBS), [one(0.5, 0.5), one(0.9, 0.1)]
    assert [check.next(recordings, None)["id"] for _ in range(2)] == [0, 0]


def test_a_recording_without_labels_is_nothing_to_check():
    assert order([[], [made_row("x.wav", None, error="is empty")]]) == []


@pytest.fixture
def sounds(tmp_path):
    """Two hisses, two tones, and what is no sound."""
    rng, time_ = np.random.default_rng(0), np.arange(16_000) / 16_000.0
    hiss, tone = rng.normal(size=(2, 16_000)), np.sin(2.0 * np.pi * 900.0 * time_)
    jobs = []
    for number, samples in enumerate((hiss[0], hiss[1], tone, 0.5 * tone)):
        run = Recording(samples[None], 16_000.0, (Channel("pressure"),))
        path = write_recording(tmp_path / f"{number}.wav", run)
        jobs.append(Job(number, Path(path), path.name))
    (tmp_path / "4.wav").write_bytes(b"no sound")
    return [*jobs, Job(4, tmp_path / "4.wav", "4.wav")]


def test_sounds_that_are_alike_are_not_asked_one_after_the_other(sounds):
    describing = SegmentFeatures()
    recordings = [one(p, 1.0 - p, end=1.0) for p in (0.5, 0.51, 0.52, 0.53)]
    wanted = [(str(job.path.absolute()), "all", 0.0, 1.0) for job in sounds]
    try:
        describing.ask([wanted[4], *wanted[:4]])
        until = time.monotonic() + 6 * PATIENCE  # its process lets all others go first
        while len(describing.known()) < 4 and time.monotonic() < until:
            time.sleep(0.05)
        first, second, *_ = order(recordings, sounds, describing)
        assert first == 0
        assert second in (2, 3)
        assert wanted[4] not in describing.known()
    finally:
        describing.stop()


def test_a_segment_is_described_by_what_of_it_is_in_the_recording(sounds):
    found = mean_features(sounds[0].path, "all", 0.0, 1.0)
    beyond = mean_features(sounds[0].path, "all", 0.0, 2.0)
    assert found.shape == (len(FEATURE_NAMES),)
    np.testing.assert_array_equal(found, mean_features(sounds[0].path, "1", 0.0, 1.0))
    assert np.isfinite(beyond).sum() == np.isfinite(found).sum() > 0
    assert np.isnan(mean_features(sounds[0].path, "all", 1.5, 2.0)).all()
