"""Measured systems whose missing effect is known."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.helpers.real_effects import ABSENT, FOLDER, paper_on_paper, silverbox

pytestmark = [pytest.mark.slow, pytest.mark.skipif(not FOLDER, reason=ABSENT)]


def test_the_silverbox_lacks_a_cubic_spring():
    found = silverbox(Path(FOLDER))
    assert found.verdict == "cubic_stiffness"
    assert found.equivalent == ("cubic_stiffness",)
    arrow = found.first.closed["arrow"]
    assert arrow.low >= 0.93
    assert found.first.closed_by_effect["arrow"].low >= 0.93
    assert found.first.gap_after["arrow"].value < 1e-3
    assert all(one.gap_after["held out"].value > 6e-3 for one in found.findings[1:])


def test_paper_on_paper_is_not_given_a_name_that_leaves_most_of_the_gap():
    found = paper_on_paper(Path(FOLDER))
    assert len(found.records) == 6
    best = found.terms[0]
    assert best.gap <= found.recalibrated.gap
    if found.verdict != "unknown":
        assert found.closed_by_effect(best) >= 0.5
