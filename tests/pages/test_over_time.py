"""Level over time and order map on pages: of a run-up on every one that shows a recording."""

import numpy as np
import pytest

from models.recording import Channel, Recording
from noise.diagnosis.outcome import Illustration
from noise.labels.segments import Segment
from noise.pages.diagnosis_evidence import illustration_entries
from noise.pages.report import ReportEntry, write_report
from noise.pages.review import review
from noise.recordings import write_recording

RATE = 16_000
SECONDS = 4.0


def run_up(last=8.0):
    """A whine of 60 cycles a revolution while the shaft runs up to a speed [rad/s]."""
    speed = np.linspace(1.0, last, round(SECONDS * RATE))
    whine = 0.1 * np.sin(60.0 * np.cumsum(speed) / RATE)
    return Recording(np.vstack([whine, speed]), RATE, (Channel("pressure"), Channel("speed")))


@pytest.mark.parametrize(("last", "maps"), [(8.0, 1), (1.0, 0)])
def test_a_review_and_a_report_draw_both_of_a_run_up_and_no_orders_at_one_speed(
    tmp_path, last, maps
):
    recording = run_up(last)
    write_recording(tmp_path / "run.wav", recording)
    review(tmp_path / "run.wav", tmp_path / "review.html", classify=False)
    segment = Segment("all", 0.0, SECONDS, "none", {"none": 1.0}, None, 70.0, -20.0)
    entry = ReportEntry("run", recording, segment)
    write_report(tmp_path / "report.html", [entry], title="Run")
    for page in ("review.html", "report.html"):
        text = (tmp_path / page).read_text(encoding="utf-8")
        assert text.count('<svg class="level"') == 1
        assert text.count('class="orders"') == maps


def test_a_diagnosis_has_the_orders_of_what_was_measured_and_of_the_model():
    found = illustration_entries(Illustration("run", run_up(), run_up(), None))
    assert {role: entry.orders is not None for role, entry in found.items()} == {
        "measured": True,
        "before": True,
    }
