"""What the classifier learns from is what it is said to be."""

from collections import Counter

import numpy as np
import pytest

from noise.classifier import LABELS
from noise.noise_definition import label_by_physics
from noise.training.classifier.bushings import random_extras, random_run, stretch
from noise.training.classifier.samples import (
    SHARES,
    SOURCES,
    bushing_recording,
    draw,
    draw_from,
)
from sim.effects import EFFECTS


@pytest.fixture(scope="module")
def runs():
    return [random_run(np.random.default_rng(seed)) for seed in range(6)]


def test_a_drawn_bushing_is_called_by_its_physics(runs):
    for drawn in runs:
        if drawn.run.recording.condition.speed is not None:
            assert drawn.label == label_by_physics(drawn.run)


def test_every_piece_of_a_run_of_varying_speed_has_the_label_of_the_whole(runs):
    varying = [d for d in runs if d.run.recording.condition.speed is None]
    for drawn in varying:
        seconds = drawn.run.pressure.size / drawn.run.motion.rate
        assert seconds >= 0.5
        for i in range(int(seconds / 0.25 + 1e-6)):
            assert label_by_physics(stretch(drawn.run, 0.25 * i, 0.25 * (i + 1))) == drawn.label
    assert varying


def test_a_bushings_sample_tells_the_condition_it_was_simulated_at(runs):
    for drawn in runs:
        recording, span = bushing_recording(drawn, np.random.default_rng(1))
        assert recording.condition == drawn.run.recording.condition
        assert recording.condition.material is not None
        assert 0.0 <= span[0] < span[1] <= recording.duration + 1e-3
        assert not recording.calibrated


def test_extras_are_admitted_by_their_effects():
    names = set()
    for seed in range(400):
        for spec in random_extras((), np.random.default_rng(seed)):
            EFFECTS[spec.name].active(spec.parameters)
            names.add(spec.name)
    assert len(names) >= 18


@pytest.mark.parametrize("source", [s for s in SOURCES if s != "bushing"])
def test_every_source_gives_a_recording_of_its_label_and_again_the_same(source):
    drawn, again = (draw_from(source, np.random.default_rng(4)) for _ in range(2))
    assert drawn.recording.samples.tobytes() == again.recording.samples.tobytes()
    assert (drawn.label, drawn.span) == (again.label, again.span)
    assert drawn.label in LABELS
    assert drawn.recording.channel_names == ("pressure",)
    assert 0.0 <= drawn.span[0] < drawn.span[1] <= drawn.recording.duration + 1e-6 < 5.1


def test_groups_come_in_their_shares(monkeypatch):
    from noise.training.classifier import samples

    # What each would sound like does not matter here.
    monkeypatch.setattr(samples, "draw_from", lambda source, _: source)
    drawn = Counter(draw(np.random.default_rng(seed)) for seed in range(6000))
    assert set(drawn) == set(SOURCES)
    groups = Counter()
    for source, count in drawn.items():
        groups[source.partition(":")[0]] += count
    for group, share in SHARES.items():
        assert groups[group] / 6000 == pytest.approx(share, abs=0.03)
