"""The score gives what it must on answers whose score is known."""

import json

import numpy as np
import pytest

from tests.blind.effects import CAUSES
from tests.blind.score.cases import Truth, read_answer, truth_of
from tests.blind.score.figures import as_json, as_text, by_bench, calibration_error, score, worst

STAGE = "friction"
NAMES = CAUSES[0], CAUSES[5], CAUSES[9]


def _truths(n=20):
    truths = []
    for i in range(n):
        truths += [Truth("none", "none", (), gap=1.0)] * 3
        truths.append(Truth("par", "parameters", ("parameters",), gap=3.0))
        truths += [Truth("one", "one", (CAUSES[k],), (STAGE,), gap=2.0 + i) for k in range(4)]
        alone = dict.fromkeys(NAMES[:2], 1.2 if i % 2 else 3.0)
        truths.append(Truth("pair", "pair", NAMES[:2], (STAGE, "drive"), 4.0, alone))
        truths.append(Truth("triple", "triple", NAMES, (STAGE,), 4.0, dict.fromkeys(NAMES, 2.0)))
        truths.append(Truth("out", "stranger", ("unknown",), (STAGE,), gap=5.0))
    return truths


def _right(truth):
    entries = [
        {"name": n, "probability": 1.0, "closed": 1.0, "closed_low": 0.9, "closed_high": 1.0}
        for n in truth.verdict
    ]
    return {
        "verdict": list(truth.verdict), "location": {"stage": [*truth.stages, None][0]},
        "effects": entries, "probabilities": dict.fromkeys(truth.names, 1.0),
    }  # fmt: skip


NOTHING = {"verdict": [], "probabilities": {"none": 1.0}}


def _values(scored):
    figures = score([(t, read_answer(d, t.case)) for t, d in scored])
    return {name: f.value for name, f in figures.items()}


SHARES = ("detected", "right first", "among three", "exact single", "stage", "parameters",
          "exact pair", "exact triple", "unknown", "closed", "covers")  # fmt: skip
LOSSES = ("false alarm", "as parameters", "named > 0.9", "ECE", "Brier", "failed")


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


def test_a_random_answer_scores_at_chance():
    rng, names = np.random.default_rng(1), ["none", "parameters", "unknown", *CAUSES]
    scored = []
    for t in _truths(60):
        p = rng.dirichlet(np.ones(len(names)))
        said = {"verdict": [names[p.argmax()]], "probabilities": dict(zip(names, p, strict=True))}
        scored.append((t, said))
    v = _values(scored)
    assert v["right first"] == pytest.approx(1 / len(names), abs=0.04)
    assert v["among three"] == pytest.approx(3 / len(names), abs=0.06)
    assert v["exact pair"] == v["exact triple"] == 0.0


def test_a_failed_diagnosis_counts_against_everything():
    v = _values([(t, None) for t in _truths(4)])
    assert {name: v[name] for name in SHARES} == dict.fromkeys(SHARES, 0.0)
    assert [v[name] for name in ("false alarm", "failed", "named > 0.9", "ECE")] == [1.0] * 4


def test_shares_are_those_that_were_put_in():
    truths = _truths()
    wrong = {
        "verdict": ["clipping"], "location": {"stage": "radiation"},
        "probabilities": {"clipping": 0.95},
    }  # fmt: skip
    v = _values([(t, wrong if i % 4 == 0 else _right(t)) for i, t in enumerate(truths)])
    strange = [i % 4 == 0 for i, t in enumerate(truths) if t.kind == "stranger"]
    assert v["named > 0.9"] == 1.0 - v["unknown"] == pytest.approx(np.mean(strange))
    nulls = [i % 4 == 0 for i, t in enumerate(truths) if t.kind == "none"]
    assert v["false alarm"] == pytest.approx(np.mean(nulls))


def test_only_cases_above_the_least_gap_count_and_pairs_each_of_which_is_plain():
    small, large = (Truth("a", "one", ("clipping",), (STAGE,), gap) for gap in (1.4, 1.6))
    v = _values([(small, NOTHING), (large, _right(large))])
    assert v["detected"] == v["right first"] == 1.0
    pairs = [t for t in _truths() if t.kind == "pair"]
    v = _values([(t, _right(t) if t.plain else NOTHING) for t in pairs])
    assert v["exact pair"] == 1.0
    assert v["detected"] == 0.5


def test_an_answer_that_cannot_be_read_is_refused():
    with pytest.raises(ValueError, match=r"case-1: probability of clipping = 1\.2"):
        read_answer({"verdict": [], "probabilities": {"clipping": 1.2}}, "case-1")
    with pytest.raises(ValueError, match="case-1: verdict"):
        read_answer({}, "case-1")


def test_closed_is_that_of_the_effect_in_the_verdict():
    entry = {"name": "clipping", "probability": 0.4, "closed": 0.8}
    other = entry | {"name": "mains_hum", "probability": 0.6, "closed": 0.1}
    answer = read_answer({"verdict": ["clipping"], "effects": [other, entry]})
    assert answer.closed == 0.8


def test_calibration_error_is_what_is_claimed_too_much():
    right = np.arange(1000) % 5 != 0
    assert calibration_error(np.column_stack([np.full(1000, 0.8), right])) < 1e-9
    assert calibration_error(np.column_stack([np.full(1000, 0.95), right])) == pytest.approx(0.15)


def test_the_worst_kind_of_bench_is_the_headline_and_what_no_case_asks_for_has_no_figure():
    def null(bench, alarm):
        said = {"verdict": ["clipping"] if alarm else [], "probabilities": {"none": 0.5}}
        return Truth("case", "none", (), bench=bench), read_answer(said)

    pairs = [null("quiet", False)] * 9 + [null("starts", True)] * 3 + [null("starts", False)]
    bench, figure = worst(by_bench(pairs))["false alarm"]
    assert bench == "starts"
    assert 0.2 < figure.low < 0.75 == figure.value < figure.high < 1.0
    text = as_text(pairs).splitlines()
    assert "starts" in text[2]
    assert "MISSED" in text[3]
    assert "detected" not in text[0]
    listed = json.loads(json.dumps(as_json(pairs), allow_nan=False))
    assert listed["figures"]["false alarm"][0] == 13


def test_a_share_of_none_has_an_interval():
    figure = score([(Truth("case", "none", ()), read_answer(NOTHING))] * 20)["false alarm"]
    assert figure.low == 0.0
    assert figure.high == pytest.approx(0.161, abs=0.001)


def test_truth_is_read_from_what_the_generator_writes():
    answer = {
        "class": "one", "verdict": ["clipping"], "gap": 2.5,
        "effects": [{"name": "clipping", "form": "x", "stage": "measurement", "strength": 0.3}],
    }  # fmt: skip
    truth = truth_of("case-0001", answer)
    assert truth == Truth("case-0001", "one", ("clipping",), ("measurement",), 2.5)
    assert truth.counts
