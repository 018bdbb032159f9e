"""Conditions that were not logged: intervals that hold, and none where nothing can be told."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import replace

import numpy as np
import pytest
from joblib import Parallel, delayed
from sklearn.ensemble import RandomForestRegressor

from models.condition import FIXED, Condition
from models.recording import Channel, RecordingBlocks
from models.rig_file import load_material_rig
from noise.base.tables import write_table
from noise.classifier import LABELS
from noise.inference import Interval, infer_stretch, load_inference
from noise.inference.model import LONGEST, QUANTITIES, scaled, unscaled
from noise.labels.conditions import conditions_map
from noise.labels.rows import label_rows
from noise.labels.segments import Segment
from noise.labels.summary import ASSUMED, assumes_material
from noise.labels.table import COLUMNS, LabelTable, read_label_table
from noise.pages.cards import facts_of
from noise.pages.clips import Entry
from noise.training.inference import draw_run_sample
from noise.training.trees import PER_LEAF, grow_quantile_forest
from sim.run import simulate

MODEL = load_inference()
PRESSURE, ALL = ["pressure"], ["pressure", "acceleration", "torque"]
FRESH = 20_000
"""Seed that no training starts from."""


def segment(recording, label="creak", channel="all"):
    even = dict.fromkeys(LABELS, 0.2)
    return Segment(channel, 0.0, recording.duration, label, even, None, None, None)


def only(recording, *kinds):
    rows = [recording[kind] for kind in kinds]
    return replace(recording, samples=np.stack(rows), channels=tuple(map(Channel, kinds)))


@pytest.fixture(scope="module")
def creak():
    """A slow, tight run, as the rig records it but for the angle."""
    rig = load_material_rig("fluorocarbon")
    run = simulate(rig, 0.6, interference=0.381e-3, support_stiffness=2214.0)
    return only(run.recording, *ALL)


@pytest.fixture(scope="module")
def heard():
    return [draw_run_sample(seed) for seed in np.random.SeedSequence(FRESH).spawn(6)]


def inferred(features, kinds, *, calibrated=True):
    of_kinds = {k: v for k, v in features.items() if k.split("_")[0] in kinds}
    return MODEL.infer(of_kinds, Condition(), kinds=kinds, calibrated=calibrated)


def ends(name, interval):
    """Bounds on the scale of a quantity."""
    at = QUANTITIES.index(name)
    return [scaled(Condition(**{name: end}))[at] for end in (interval.low, interval.high)]


def width(samples, kinds, name="interference"):
    """Mean width of the intervals on the rig; of what is not told that of the whole range."""
    whole = Interval(0.0, unscaled(name, -99.0), unscaled(name, 99.0))
    found = [inferred(sample.features[1], kinds).get(name, whole) for sample in samples]
    return float(np.mean([np.ptp(ends(name, interval)) for interval in found]))


@pytest.mark.slow
def test_intervals_hold_for_88_to_92_of_100_on_fresh_recordings():
    seeds = np.random.SeedSequence(FRESH + 1).spawn(600)
    samples = Parallel(n_jobs=-1)(delayed(draw_run_sample)(seed) for seed in seeds)
    scatter = 2.0 * math.sqrt(0.9 * 0.1 / len(samples))
    inside = defaultdict(list)
    for sample in samples:
        for on_rig, features in enumerate(sample.features):
            for kinds in (PRESSURE, ALL):
                found = inferred(features, kinds, calibrated=bool(on_rig))
                for i, name in enumerate(QUANTITIES):
                    if name in found:
                        low, high = ends(name, found[name])
                        y = float(np.float16(sample.scaled[i]))
                        inside[name, on_rig].append(low - 1e-3 <= y <= high + 1e-3)
    for case, held in inside.items():
        assert 0.88 - scatter <= np.mean(held) <= 0.92 + scatter, case


def test_torque_tells_more_than_sound_alone(heard):
    assert width(heard, ALL) < 0.8 * width(heard, PRESSURE)


def test_what_is_logged_is_never_overwritten(creak):
    logged = Condition(speed=-3.0, interference=0.2e-3, support_stiffness=FIXED)
    (row,) = label_rows("a.wav", replace(creak, condition=logged), [segment(creak)])
    assert row["speed_rad_s"] == -3.0
    assert row["interference_mm"] == 0.2
    assert math.isinf(row["support_stiffness_Nm_rad"])
    for column in ("speed_rad_s", "interference_mm", "support_stiffness_Nm_rad"):
        assert row[f"{column}_source"] == "logged"
        assert row[f"{column}_low"] is row[f"{column}_high"] is None


def test_what_is_not_logged_has_a_value_between_its_bounds_or_is_missing(creak):
    (row,) = label_rows("a.wav", replace(creak, condition=Condition()), [segment(creak)])
    assert row["interference_mm_source"] == "inferred"
    assert row["interference_mm_low"] < 0.381 < row["interference_mm_high"]
    assert row["material_source"] == "missing"
    for column in ("speed_rad_s", "interference_mm", "support_stiffness_Nm_rad"):
        value, low, high, source = (
            row[f"{column}{part}"] for part in ("", "_low", "_high", "_source")
        )
        if source == "inferred":
            assert low <= value <= high
            assert [low, value, high] == [float(f"{one:.4g}") for one in (low, value, high)]
        else:
            assert (value, low, high, source) == (None, None, None, "missing")
    for label in ("none", "unknown"):
        (row,) = label_rows("a.wav", replace(creak, condition=Condition()), [segment(creak, label)])
        assert row["interference_mm_source"] == row["speed_rad_s_source"] == "missing"


def test_intervals_are_for_the_recordings_that_they_hold_for_alone(creak):
    blocks = RecordingBlocks.of(creak)
    n = blocks.n_samples
    assert infer_stretch(blocks, 0, n, Condition(), MODEL)
    assert infer_stretch(blocks, 0, n, Condition(material="Fluorocarbon"), MODEL)
    assert not infer_stretch(blocks, 0, n, Condition(material="natural-rubber"), MODEL)
    assert not infer_stretch(blocks, 0, 5000, Condition(), MODEL)
    slow = RecordingBlocks.of(replace(creak, rate=8000.0))
    assert not infer_stretch(slow, 0, n, Condition(), MODEL)
    angle = RecordingBlocks.of(replace(only(creak, "torque"), channels=(Channel("angle"),)))
    assert not infer_stretch(angle, 0, n, Condition(), MODEL)


def test_a_sound_that_nothing_says_to_be_of_a_rig_tells_of_no_condition(creak):
    sound = replace(only(creak, *PRESSURE), condition=Condition(), calibrated=False)

    def sources(recording, inference=None):
        (row,) = label_rows("a.wav", recording, [segment(recording)], inference)
        return {row[f"{name}_source"] for name in ("speed_rad_s", "interference_mm")}

    assert sources(sound) == {"missing"}
    assert sources(replace(sound, calibrated=True)) == {"missing"}  # says how loud, not of what
    assert "inferred" in sources(replace(sound, condition=Condition(support_stiffness=2214.0)))
    # Who names a model says by it which rig the sounds are of.
    assert "inferred" in sources(sound, load_inference())


def test_what_is_inferred_says_what_it_assumes_unless_the_material_is_logged(creak):
    for material in (None, "fluorocarbon"):
        at = Condition(material=material)
        rows = LabelTable(label_rows("a.wav", replace(creak, condition=at), [segment(creak)]))
        assert "inferred" in rows[0].values()
        assert assumes_material(rows[0]) == (material is None)
        facts = facts_of(Entry("run07", (rows[0],)))
        assert facts["material"] == (material or ASSUMED)


def test_a_long_stretch_is_known_by_its_middle(creak):
    quiet = np.zeros((3, 60_000))
    long = replace(creak, samples=np.concatenate([quiet, creak.samples, quiet], axis=1))
    assert creak.duration == LONGEST
    alone, among = (
        infer_stretch(RecordingBlocks.of(r), 0, r.samples.shape[1], Condition(), MODEL)
        for r in (creak, long)
    )
    assert alone == among


def test_the_pool_of_a_forest_is_that_of_the_leaves_that_scikit_learn_finds():
    rng = np.random.default_rng(0)
    x, y = rng.normal(size=(400, 3)), rng.normal(size=400)
    x[rng.random(x.shape) < 0.1] = np.nan
    forest = grow_quantile_forest(x, y, n_trees=5, least_leaf=8, share=0.5, seed=3)
    same = RandomForestRegressor(
        n_estimators=5, min_samples_leaf=8, max_samples=0.5, max_features=0.8, random_state=3
    ).fit(x, y)
    leaves, at = same.apply(x), (np.arange(PER_LEAF) + 0.5) / PER_LEAF
    expected = [
        np.sort(
            np.concatenate(
                [
                    np.quantile(y[leaves[:, tree] == leaves[row, tree]], at, method="nearest")
                    for tree in range(5)
                ]
            )
        )
        for row in range(20)
    ]
    assert forest.pooled(x[:20]) == pytest.approx(np.array(expected), abs=2e-3)


def test_a_saved_model_infers_the_same(tmp_path, heard):
    MODEL.save(tmp_path / "copy.npz")
    again = load_inference(tmp_path / "copy.npz")
    for sample in heard:
        asked = (sample.features[1], Condition())
        assert again.infer(*asked, kinds=ALL, calibrated=True) == MODEL.infer(
            *asked, kinds=ALL, calibrated=True
        )


@pytest.mark.parametrize("ending", [".csv", ".jsonl", ".parquet", ".xlsx"])
def test_bounds_up_to_the_bolted_clamp_are_read_back(tmp_path, ending):
    support = "support_stiffness_Nm_rad"
    row = dict.fromkeys(COLUMNS) | {
        "file": "a.wav", "label": "creak", support: 4000.0, f"{support}_low": 2000.0,
        f"{support}_high": math.inf, f"{support}_source": "inferred",
    }  # fmt: skip
    write_table(tmp_path / f"t{ending}", COLUMNS, [row])
    (back,) = read_label_table(tmp_path / f"t{ending}")
    assert back == row | {"calibrated": back["calibrated"]}


def test_the_map_takes_what_was_logged_and_not_what_was_inferred():
    row = dict.fromkeys(COLUMNS) | {
        "file": "a.wav", "label": "creak", "start_s": 0.0, "end_s": 1.0,
        "speed_rad_s": 5.0, "speed_rad_s_source": "inferred",
        "interference_mm": 0.279, "interference_mm_source": "logged",
    }  # fmt: skip
    (place,) = conditions_map([row])
    assert place.speed is None
    assert place.interference.middle == 0.279
