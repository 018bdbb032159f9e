"""Fresh repeats are of the same truth; what an improved rig leaves is counted on them."""

import numpy as np

from tests.blind.cases import run_case
from tests.blind.design import draw_design
from tests.blind.effects import DEVELOPMENT
from tests.blind.score.improving import table


def test_fresh_repeats_are_of_the_same_truth_and_other_chance():
    design = draw_design(3, 0, DEVELOPMENT)
    case, fresh = run_case(design), run_case(design, again=1)
    assert case.answer == fresh.answer
    for one, other in zip(case.recordings, fresh.recordings, strict=True):
        assert one.shape == other.shape
        assert not np.array_equal(one, other)
        assert 0.5 < np.abs(one[0]).mean() / np.abs(other[0]).mean() < 2.0


def _row(index, written, again, fresh):
    left = {"gap": 1.0, "p_value": 0.5, "none": 0.5}
    return {
        "index": index, "effect": "clipping", "form": "hard", "strength": 0.3, "gap": 3.0,
        "verdict": ["clipping"], "written": written, "seconds": 60.0,
        "fitted": {"verdict": again, **left}, "fresh": {"verdict": fresh, **left},
    }  # fmt: skip


def test_only_fresh_repeats_without_a_gap_count_as_closed():
    rows = [
        _row(0, "improved.toml", [], []),
        _row(1, "improved.toml", [], ["clipping"]),
        _row(2, None, ["clipping"], ["clipping"]),
        _row(3, None, ["clipping"], []),
    ]
    said = table(rows)
    assert "all cases, fresh repeats (aim 0.60): 0.50 (2 of 4" in said
    assert "written, fresh repeats (aim 0.85): 0.50 (1 of 2" in said
    assert "written, recordings fitted to: 1.00 (2 of 2" in said
    assert "file written: 0.50 (2 of 4" in said
