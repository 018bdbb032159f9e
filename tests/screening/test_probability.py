"""Probability of each noise among parts, against brute force."""

import numpy as np
import pytest
from scipy import stats

from models.errors import ParameterError
from models.rig_file import load_material_rig
from noise.screening.parts.probability import NOISES, label_probabilities
from noise.screening.parts.sampling import parts
from sim.analysis.sweep import sweep

DESIGN = {
    "stiffness": stats.norm(1.0, 0.05),
    "friction": stats.lognorm(np.sqrt(np.log1p(0.2**2))),
    "damping": stats.uniform(0.7, 0.6),
}


def noise_of(parts):
    """Made-up physics with a curved boundary, an island and a rare noise."""
    stiffness, friction, damping = parts.T
    drive = friction**2 / damping
    label = np.where(drive > 1.2, "creak", "none").astype(object)
    label[(drive < 0.95) & (np.abs(stiffness - 1.02) < 0.015)] = "squeal"
    label[(drive > 1.15) & (stiffness < 0.93)] = "squawk"
    return label


def by_brute_force(labels_of, distributions, n, seed=0):
    points = np.random.default_rng(seed).random((n, len(distributions)))
    found = labels_of(parts(distributions, points))
    return {label: float(np.mean(found == label)) for label in NOISES}


def covered(labels_of, distributions, truth, repeats, **options):
    """How often each interval holds the truth, and the parts that it took."""
    runs = [
        label_probabilities(labels_of, distributions, np.random.default_rng(seed), **options)
        for seed in range(repeats)
    ]
    assert all(run.reached for run in runs)
    held = {
        label: sum(run.by_label[label].low <= p <= run.by_label[label].high for run in runs)
        for label, p in truth.items()
    }
    return held, float(np.mean([run.samples for run in runs]))


@pytest.mark.parametrize(("confidence", "half_width"), [(0.95, 0.08), (0.8, 0.05)])
def test_intervals_hold_the_truth_as_often_as_they_state(confidence, half_width):
    truth = by_brute_force(noise_of, DESIGN, 1_000_000)
    assert min(truth.values()) > 0.01
    held, _ = covered(noise_of, DESIGN, truth, 60, confidence=confidence, half_width=half_width)
    # Fewer would happen once in a thousand times if the confidence were just as stated.
    least = stats.binom.ppf(0.001, 60, confidence)
    assert min(held.values()) >= least


@pytest.mark.slow
def test_intervals_hold_what_twenty_thousand_simulated_parts_give():
    rig = load_material_rig("fluorocarbon-thesis")
    distributions = {
        "interference": stats.truncnorm(-3.0, 3.0, loc=0.279e-3, scale=0.015e-3),
        "support_stiffness": stats.norm(3745.0, 0.08 * 3745.0),
        "speed": stats.uniform(4.0, 4.0),
    }

    def sticks(parts):
        interference, support_stiffness, speed = parts.T
        runs = sweep(
            rig, speed, interference, support_stiffness, seconds=0.3, settling=0.3, rate=15e3
        )
        return np.where(runs["stick_fraction"] > 0.02, "creak", "none")

    truth = by_brute_force(sticks, distributions, 20_000)
    assert 0.1 < truth["creak"] < 0.9
    held, samples = covered(sticks, distributions, truth, 60, half_width=0.08)
    assert min(held.values()) >= stats.binom.ppf(0.001, 60, 0.95)
    assert samples < 300


def test_it_stops_once_every_interval_is_narrow_enough():
    def widest(half_width):
        rng = np.random.default_rng(5)
        return label_probabilities(noise_of, DESIGN, rng, half_width=half_width)

    coarse, fine = widest(0.1), widest(0.02)
    assert coarse.half_width <= 0.1
    assert fine.half_width <= 0.02
    assert coarse.samples < fine.samples


def test_a_smooth_boundary_takes_fewer_parts_than_chance():
    friction = {"friction": stats.norm(1.0, 0.1)}

    def creaks(parts):
        return np.where(parts[:, 0] > 1.05, "creak", "none")

    found = label_probabilities(creaks, friction, np.random.default_rng(0), half_width=0.02)
    p = found.by_label["creak"].value
    assert p == pytest.approx(stats.norm.sf(0.5), abs=0.02)
    assert found.samples < 0.7 * 1.96**2 * p * (1.0 - p) / 0.02**2


def test_a_noise_that_no_part_made_may_still_be_rare():
    def silent(parts):
        return np.full(len(parts), "none")

    found = label_probabilities(silent, DESIGN, np.random.default_rng(0))
    squeal = found.by_label["squeal"]
    assert (squeal.value, squeal.low) == (0.0, 0.0)
    # The rule of three: nothing in n says less than 3.7 in n at 97.5 %.
    assert squeal.high == pytest.approx(3.7 / found.samples, rel=0.05)
    assert found.any_but("none").high == pytest.approx(squeal.high)


def test_probabilities_of_all_labels_add_up():
    found = label_probabilities(noise_of, DESIGN, np.random.default_rng(1))
    assert sum(one.value for one in found.by_label.values()) == pytest.approx(1.0)
    assert found.any_but("none").value == pytest.approx(1.0 - found.by_label["none"].value)
    assert all(one.low <= one.value <= one.high for one in found.by_label.values())


def test_a_label_of_its_own_is_told_of():
    def unknown(parts):
        return np.where(parts[:, 0] > 1.0, "unknown", "none")

    found = label_probabilities(unknown, DESIGN, np.random.default_rng(1))
    assert set(found.by_label) == {*NOISES, "unknown"}


def test_too_few_parts_are_said_to_be():
    found = label_probabilities(
        noise_of, DESIGN, np.random.default_rng(1), half_width=0.01, most=200
    )
    assert found.samples == 128
    assert not found.reached
    assert found.half_width > 0.01


def test_it_follows_from_the_generator_alone():
    one, other = (
        label_probabilities(noise_of, DESIGN, np.random.default_rng(7)).by_label for _ in range(2)
    )
    assert one == other


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"half_width": 0.0}, "half_width = 0 "),
        ({"confidence": 1.0}, "confidence = 1 "),
        ({"most": 10}, "most = 10 "),
    ],
)
def test_what_cannot_be_reached_is_refused(options, message):
    with pytest.raises(ParameterError, match=message):
        label_probabilities(noise_of, DESIGN, np.random.default_rng(0), **options)


def test_one_label_a_part_is_asked_for():
    with pytest.raises(ParameterError, match="64 parts got labels of shape"):
        label_probabilities(lambda parts: parts, DESIGN, np.random.default_rng(0))
