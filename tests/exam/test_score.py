"""The score gives what it must on answers whose score is known."""

import json

import numpy as np
import pytest

from tests.blind.effects import CAUSES
from tests.blind.score.answers import read_answer, same_names
from tests.blind.score.baselines import BASELINES
from tests.blind.score.bootstrap import Aim, Quantity, at_least, at_most, figure
from tests.blind.score.picture import confusion, draw_confusion
from tests.blind.score.probabilities import LEAST, calibration_error
from tests.blind.score.table import as_json, as_text, loss, score
from tests.blind.score.truth import Truth, truth_of
from tests.blind.score.unknowns import auroc, recall

STAGE = "friction"


def _truths(n=20):
    truths = [Truth(f"none{i}", "none", (), gap=1.0) for i in range(3 * n)]
    truths += [Truth(f"par{i}", "parameters", ("parameters",), gap=3.0) for i in range(n)]
    for i in range(4 * n):
        truths.append(
            Truth(f"one{i}", "one", (CAUSES[i % 4],), (STAGE,), 0.012 * 1.05**i, gap=2.0 + i)
        )
    names = CAUSES[0], CAUSES[5], CAUSES[9]
    for i in range(n):
        truths.append(
            Truth(f"pair{i}", "pair", names[:2], (STAGE, "drive"), gap=4.0,
                  alone=dict.fromkeys(names[:2], 1.2 if i % 2 else 3.0))
        )  # fmt: skip
        truths.append(Truth(f"tri{i}", "triple", names, (STAGE, "drive", "structure"), gap=4.0))
        truths.append(Truth(f"out{i}", "stranger", ("unknown",), (STAGE,), gap=5.0))
    return truths


def _values(scored, **options):
    figures = score(scored, draws=20, **options).figures
    return {name: f.value for name, f in figures.items()}


def _baseline(name, truths):
    rng = np.random.default_rng(1)
    return [(t, BASELINES[name](t, CAUSES, rng)) for t in truths]


def test_who_knows_the_truth_reaches_every_score():
    v = _values(_baseline("oracle", _truths()))
    ones = [
        "detection", "stage", "parameters told from physics", "right cause first",
        "right cause among three", "probability on the true cause", "exact single", "exact pair",
        "exact triple", "unknown: AUROC", "unknown: recall at 5 %", "unknown: said so",
        "closed, median", "interval of closed covers", f"cause {CAUSES[0]}",
    ]  # fmt: skip
    zeros = [
        "false alarms on null cases", "failed", "unknown: named with p > 0.9", "Brier",
        "log score", "ECE", "closed, error against the truth's own",
    ]  # fmt: skip
    assert {name: v[name] for name in ones} == dict.fromkeys(ones, 1.0)
    assert {name: v[name] for name in zeros} == dict.fromkeys(zeros, 0.0)


def test_saying_none_always_alarms_never_and_finds_nothing():
    v = _values(_baseline("none", _truths()))
    zeros = ["false alarms on null cases", "detection", "stage", "parameters told from physics",
             "right cause first", "probability on the true cause", "exact pair", "exact triple",
             "unknown: recall at 5 %", "closed, median"]  # fmt: skip
    assert {name: v[name] for name in zeros} == dict.fromkeys(zeros, 0.0)
    assert v["unknown: AUROC"] == 0.5
    # 60 nulls of 220 cases are right; one name is wrong of 120, two of 20, three of 20
    assert v["Brier"] == pytest.approx((120 * 2 + 20 * 3 + 20 * 4) / 220)
    assert v["log score"] == pytest.approx(-160 * np.log(LEAST) / 220)
    assert v["ECE"] == pytest.approx(160 / 220)


def test_a_random_answer_scores_at_chance():
    v = _values(_baseline("random", _truths(60)))
    names = len(CAUSES) + 3
    assert v["false alarms on null cases"] == pytest.approx(1 - 1 / names, abs=0.06)
    assert v["right cause first"] == pytest.approx(1 / names, abs=0.04)
    assert v["right cause among three"] == pytest.approx(3 / names, abs=0.06)
    assert v["probability on the true cause"] == pytest.approx(1 / names, abs=0.02)
    assert v["stage"] < 0.45
    assert v["exact pair"] == v["exact triple"] == 0.0
    assert v["parameters told from physics"] == pytest.approx(0.5, abs=0.08)
    assert v["unknown: AUROC"] == pytest.approx(0.5, abs=0.15)
    assert v["unknown: recall at 5 %"] < 0.2
    assert v["log score"] > 2.0


def test_a_failed_diagnosis_counts_against_everything():
    v = _values([(t, None) for t in _truths(4)])
    zeros = ["detection", "stage", "parameters told from physics", "right cause first",
             "unknown: AUROC", "closed, median", "interval of closed covers"]  # fmt: skip
    ones = ["false alarms on null cases", "failed", "unknown: named with p > 0.9"]
    assert {name: v[name] for name in zeros} == dict.fromkeys(zeros, 0.0)
    assert {name: v[name] for name in ones} == dict.fromkeys(ones, 1.0)
    assert v["ECE"] == 1.0


def _said(verdict, stage=STAGE, **more):
    return {"verdict": list(verdict), "location": {"stage": stage}, "effects": [], **more}


def test_shares_are_those_that_were_put_in():
    truths = _truths()
    scored = []
    for i, t in enumerate(truths):
        wrong = _said(["clipping"], "radiation", probabilities={"clipping": 0.95})
        scored.append((t, wrong if i % 4 == 0 else BASELINES["oracle"](t, CAUSES, None)))
    v = _values(scored)
    assert v["false alarms on null cases"] == 0.25
    assert v["right cause first"] == 0.75
    assert v["stage"] == pytest.approx(90 / 120)
    assert v["unknown: named with p > 0.9"] == pytest.approx(
        sum(i % 4 == 0 for i, t in enumerate(truths) if t.kind == "stranger") / 20
    )
    assert v["parameters told from physics"] == pytest.approx((0.75 + 1.0) / 2)
    assert v["unknown: recall at 5 %"] == v["unknown: said so"]


def test_only_cases_above_the_least_gap_count_but_for_false_alarms():
    small = Truth("a", "one", ("clipping",), ("measurement",), 0.02, gap=1.4)
    large = Truth("b", "one", ("clipping",), ("measurement",), 0.5, gap=1.6)
    v = _values([(small, _said([])), (large, _said(["clipping"], "measurement"))])
    assert v["detection"] == v["right cause first"] == 1.0
    assert v["detection at strength 0.01 to 0.025"] == 0.0
    assert v["detection at strength 0.4 to 1"] == 1.0
    assert v["detection at a gap of 1.25 to 1.5"] == 0.0
    assert v["detection at a gap of 1.5 to 2"] == 1.0


def test_pairs_of_which_each_is_plain_are_scored_by_themselves_too():
    scored = [
        (t, BASELINES["oracle"](t, CAUSES, None) if min(t.alone.values()) > 1.5 else _said([]))
        for t in _truths()
        if t.kind == "pair"
    ]
    v = _values(scored)
    assert v["exact pair"] == 0.5
    assert v["exact pair, each plain by itself"] == 1.0


def test_equivalent_effects_count_as_one():
    truth = Truth("a", "one", ("speed_fluctuation",), ("drive",), 0.5, gap=3.0)
    said = _said(
        ["critical_torque_scatter"], "drive",
        probabilities={"critical_torque_scatter": 0.6, "speed_fluctuation": 0.3, "none": 0.1},
    )  # fmt: skip
    assert _values([(truth, said)])["right cause first"] == 0.0
    same = same_names([["speed_fluctuation", "critical_torque_scatter"]])
    v = _values([(truth, said)], same=same)
    assert v["right cause first"] == v["exact single"] == 1.0
    assert v["probability on the true cause"] == pytest.approx(0.9)


def test_declared_classes_that_overlap_are_one():
    assert set(same_names([["a", "b"], ["c", "d"], ["b", "c"]]).values()) == {"a"}


def test_probabilities_fall_back_on_effects_and_what_they_leave():
    entries = [{"name": "clipping", "probability": 0.7}, {"name": "mains_hum", "probability": 0.2}]
    p = read_answer({"verdict": ["clipping"], "effects": entries}).probability
    assert p == pytest.approx(
        {"clipping": 0.7, "mains_hum": 0.2, "none": 0.1 / 3, "parameters": 0.1 / 3,
         "unknown": 0.1 / 3}
    )  # fmt: skip
    entries.append({"name": "unknown", "probability": 0.05})
    p = read_answer({"verdict": [], "effects": entries}).probability
    assert p["none"] == pytest.approx(0.05)
    assert read_answer({"verdict": ["parameters"]}).probability == {"parameters": 1.0}


def test_an_answer_that_cannot_be_read_is_refused():
    with pytest.raises(ValueError, match=r"case-1: probability of clipping = 1\.2"):
        read_answer({"verdict": [], "probabilities": {"clipping": 1.2}}, "case-1")
    with pytest.raises(ValueError, match="case-1: verdict"):
        read_answer({}, "case-1")


def test_closed_is_that_of_the_effect_in_the_verdict():
    entry = {"name": "clipping", "probability": 0.4, "closed": 0.8, "closed_low": 0.7,
             "closed_high": 0.9}  # fmt: skip
    other = entry | {"name": "mains_hum", "probability": 0.6, "closed": 0.1}
    truth = Truth("a", "one", ("clipping",), ("measurement",), 0.5, gap=3.0, closed=0.85)
    said = {"verdict": ["clipping"], "effects": [other, entry]}
    v = _values([(truth, said)])
    assert v["closed, median"] == 0.8
    assert v["closed, error against the truth's own"] == pytest.approx(0.05)
    assert v["interval of closed covers"] == 1.0
    assert v["interval of closed, width"] == pytest.approx(0.2)
    nothing = _values([(truth, said | {"effects": []})])
    assert nothing["closed, median"] == nothing["interval of closed covers"] == 0.0


def test_auroc_and_recall_of_known_ranks():
    rows = np.array([[0.9, 1], [0.4, 1], [0.4, 0], [0.1, 0], [0.2, 0], [0.3, 0]])
    assert auroc(rows) == pytest.approx((4 + 3.5) / 8)
    assert recall(rows) == 0.5
    others = np.column_stack([np.linspace(0.0, 1.0, 101), np.zeros(101)])
    strangers = np.array([[0.955, 1], [0.945, 1]])
    assert recall(np.vstack([others, strangers])) == 0.5


def test_calibration_error_is_what_is_claimed_too_much():
    right = np.arange(1000) % 5 != 0
    assert calibration_error(np.column_stack([np.full(1000, 0.8), right])) < 1e-9
    assert calibration_error(np.column_stack([np.full(1000, 0.95), right])) == pytest.approx(0.15)


def test_intervals_cover_as_often_as_they_say():
    rng = np.random.default_rng(2)
    inside = 0
    for _ in range(200):
        f = figure(Quantity.of("share", rng.random(80) < 0.7), rng, draws=200)
        inside += f.low <= 0.7 <= f.high
    assert 0.90 <= inside / 200 <= 0.99


def test_an_aim_is_met_inside_or_beyond_the_interval():
    assert at_least(0.95).met(0.93, 0.96)
    assert at_least(0.95).met(0.97, 0.99)
    assert not at_least(0.95).met(0.90, 0.94)
    assert at_most(0.02).met(0.01, 0.05)
    assert not at_most(0.02).met(0.03, 0.05)
    assert Aim(0.88, 0.92).met(0.85, 0.89)
    assert not Aim(0.88, 0.92).met(0.93, 1.0)


def test_what_no_case_asks_for_has_no_figure():
    figures = score([(Truth("a", "none", (), gap=1.0), _said([]))], draws=5).figures
    assert figures["detection"].value is None
    assert figures["detection"].met is None
    assert "detection " not in as_text(figures)
    assert as_json(figures)["false alarms on null cases"]["met"] is True
    json.dumps(as_json(figures), allow_nan=False)


def test_loss_is_own_less_others():
    truths = [t for t in _truths() if t.kind == "one"]
    own = score(_baseline("oracle", truths), draws=100)
    half = [
        (t, BASELINES["oracle" if i % 2 else "none"](t, CAUSES, None)) for i, t in enumerate(truths)
    ]
    lost = loss(own, score(half, draws=100))["loss: right cause first"]
    assert lost.value == 0.5
    assert 0.3 < lost.low < 0.5 < lost.high < 0.7


def test_confusion_counts_cases_and_is_drawn(tmp_path):
    truths = _truths(2)
    scored = [*_baseline("oracle", truths), *_baseline("none", truths[:7]), (truths[9], None)]
    pairs = score(scored, draws=5).pairs
    names, counts = confusion(pairs)
    assert names[:3] == ["none", "parameters", "unknown"]
    assert counts.sum() == len([t for t in truths if len(t.names) == 1]) + 8
    assert counts[names.index("parameters"), names.index("none")] == 1
    assert counts[:, -1].sum() == 1
    draw_confusion(pairs, tmp_path / "confusion.png")
    assert tmp_path.joinpath("confusion.png").read_bytes().startswith(b"\x89PNG")


def test_truth_is_read_from_what_the_generator_writes():
    answer = {
        "class": "one", "verdict": ["clipping"], "gap": 2.5,
        "effects": [{"name": "clipping", "form": "x", "stage": "measurement", "strength": 0.3}],
    }  # fmt: skip
    truth = truth_of("case-0001", answer)
    assert truth == Truth("case-0001", "one", ("clipping",), ("measurement",), 0.3, 2.5)
    assert truth.counts
