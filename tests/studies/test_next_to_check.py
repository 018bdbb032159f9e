"""The study of "Next to check": nothing held out is learned from, a correction is the app's."""

import numpy as np
import pytest

from models.recording import Channel, Recording
from noise.classifier import load_classifier
from noise.labels.labelling import Labelling
from noise.recordings import write_recording
from tests.studies.next_to_check.experiment import (
    at_random,
    by_next_to_check,
    errors,
    labels_of,
)
from tests.studies.next_to_check.folders import Clip, halves, known_and_folder


@pytest.fixture
def clips(tmp_path):
    """Six tones and six hisses, of two sources each, with a second of silence behind."""
    rng, time = np.random.default_rng(0), np.arange(16_000) / 16_000.0
    found = []
    for number in range(12):
        tone = number % 2 == 0
        sound = np.sin(2e3 * np.pi * time) if tone else 0.3 * rng.normal(size=time.size)
        run = Recording(
            0.1 * np.concatenate([sound, np.zeros(16_000)])[None], 16_000.0, (Channel("pressure"),)
        )
        path = write_recording(tmp_path / f"{number}.wav", run)
        label = "squeal" if tone else "unknown"
        found.append(Clip(path, label, f"{label} {number // 4}"))
    return found


def test_no_source_is_on_two_sides_and_every_label_is_on_both(clips):
    known, folder = known_and_folder(clips)
    pool, held = halves(folder, 0)
    sources = [{clip.source for clip in part} for part in (known, pool, held)]
    assert sum(map(len, sources)) == len({clip.source for clip in clips})
    assert {clip.label for clip in known} == {"unknown"}
    assert {clip.label for clip in pool} == {clip.label for clip in held} == {"squeal", "unknown"}


def test_a_correction_says_what_sounds_and_nothing_of_the_silence(clips):
    said = clips[0].correction
    assert {(one.label, one.name) for one in said} == {("squeal", str(clips[0].path.resolve()))}
    assert len(said) == 2  # a second and the end of the tone, in windows of a second at most


def test_labels_are_those_of_the_command(clips):
    (rows,) = labels_of(clips[:1], load_classifier())
    told, _ = Labelling().rows(clips[0].path, "0.wav")
    assert [(row["label"], row["start_s"], row["p_squeal"]) for row in rows] == [
        (row["label"], row["start_s"], row["p_squeal"]) for row in told
    ]


def test_both_orders_ask_for_recordings_once(clips):
    rows = labels_of(clips, load_classifier())
    for order in (by_next_to_check(clips, rows, 5), at_random(clips, 0, 5)):
        assert len(set(order)) == 5


def test_what_is_no_noise_may_be_called_nothing(clips):
    p = {"p_creak": 0.0, "p_squawk": 0.0, "p_squeal": 0.2, "p_none": 0.5, "p_unknown": 0.3}
    rows = [[{"label": "none", "start_s": 0.0, "end_s": 1.0, **p}] for _ in clips]
    found = errors(clips, rows)
    assert (found["unknown"], found["squeal"], found["all"], found["mean"]) == (0.0, 1.0, 0.5, 0.5)
    assert found["probability"] == pytest.approx(0.5 * (0.2 + 0.8))
