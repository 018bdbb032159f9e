"""The score gives what it must on answers whose score is known."""

import pytest

from tests.blind.effects import CAUSES
from tests.blind.score import FAILED, figures, read_diagnosis, table

NAMES = [CAUSES[0], CAUSES[5], CAUSES[9]]
NOTHING = {"verdict": [], "probabilities": {"none": 1.0}}
SHARES = ("detected", "right first", "among three", "stage", "parameters", "exact pair",
          "exact triple", "unknown", "closed")  # fmt: skip
LOSSES = ("false alarm", "named > 0.9", "ECE", "Brier", "failed")


def _truth(kind, verdict, gap=4.0, alone=(), bench="quiet"):
    effects = [{"name": name, "stage": "friction"} for name in verdict]
    return {
        "class": kind, "verdict": list(verdict), "effects": effects, "gap": gap,
        "gap_alone": dict(zip(verdict, alone, strict=False)), "bench": bench,
    }  # fmt: skip


def _truths(n=20):
    truths = []
    for i in range(n):
        truths += [_truth("none", [], 1.0)] * 3 + [_truth("parameters", ["parameters"])]
        truths += [_truth("one", [CAUSES[k]], 2.0 + i) for k in range(4)]
        truths.append(_truth("pair", NAMES[:2], alone=[1.2 if i % 2 else 3.0] * 2))
        truths.append(_truth("triple", NAMES, alone=[2.0] * 3))
        truths.append(_truth("stranger", ["unknown"]))
    return truths


def _right(truth):
    return {
        "verdict": truth["verdict"], "location": {"stage": "friction"},
        "effects": [{"name": n, "probability": 1.0, "closed": 1.0} for n in truth["verdict"]],
        "probabilities": dict.fromkeys(truth["verdict"] or ["none"], 1.0),
    }  # fmt: skip


def _values(scored):
    return {name: f.value for name, f in figures(_pairs(scored)).items()}


def _pairs(scored):
    return [(truth, read_diagnosis(said)) for truth, said in scored]


def test_who_knows_the_truth_reaches_every_score():
    v = _values([(t, _right(t)) for t in _truths()])
    assert {name: v[name] for name in SHARES} == dict.fromkeys(SHARES, 1.0)
    assert {name: v[name] for name in LOSSES} == dict.fromkeys(LOSSES, 0.0)


def test_saying_none_always_alarms_never_and_finds_nothing():
    v = _values([(t, NOTHING) for t in _truths()])
    assert {name: v[name] for name in SHARES} == dict.fromkeys(SHARES, 0.0)
    assert v["false alarm"] == 0.0
    # 60 nulls of 220 cases are right; one name is wrong of 120, two of 20, three of 20
    assert v["Brier"] == pytest.approx((120 * 2 + 20 * 3 + 20 * 4) / 220)
    assert v["ECE"] == pytest.approx(160 / 220)


def test_a_failed_diagnosis_counts_against_everything():
    v = _values([(t, FAILED) for t in _truths(4)])
    assert {name: v[name] for name in SHARES} == dict.fromkeys(SHARES, 0.0)
    assert [v[name] for name in ("false alarm", "failed", "named > 0.9", "ECE")] == [1.0] * 4


def test_only_cases_above_the_least_gap_count_and_pairs_each_of_which_is_plain():
    small, large = (_truth("one", ["clipping"], gap) for gap in (1.4, 1.6))
    v = _values([(small, NOTHING), (large, _right(large))])
    assert v["detected"] == v["right first"] == 1.0
    pairs = [t for t in _truths() if t["class"] == "pair"]
    v = _values([(t, _right(t) if min(t["gap_alone"].values()) > 1.5 else NOTHING) for t in pairs])
    assert (v["exact pair"], v["detected"]) == (1.0, 0.5)


def test_a_table_has_a_row_for_each_kind_of_bench_and_a_share_of_none_an_interval():
    pairs = _pairs([(_truth("none", [], 1.0), NOTHING)] * 20)
    figure = figures(pairs)["false alarm"]
    assert (figure.cases, figure.low) == (20, 0.0)
    assert figure.high == pytest.approx(0.161, abs=0.001)
    starts = _pairs([(_truth("one", ["clipping"], bench="starts"), NOTHING)])
    rows = table([*pairs, *starts]).splitlines()
    assert [row.split(" | ")[0] for row in rows[2:]] == ["| quiet", "| starts", "| all"]
    assert "0.00 (0.00-0.16; 20)" in rows[2]
