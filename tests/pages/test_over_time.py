"""Level over time on pages: of a run-up on every one that shows a recording."""

import numpy as np

from models.recording import Channel, Recording
from noise.labels.segments import Segment
from noise.pages.report import ReportEntry, write_report
from noise.pages.review import review
from noise.recordings import write_recording

RATE = 16_000
SECONDS = 4.0


def test_a_review_and_a_report_draw_the_level(tmp_path):
    whine = 0.1 * np.sin(2000.0 * np.arange(SECONDS * RATE) / RATE)
    recording = Recording(whine[np.newaxis], RATE, (Channel("pressure"),))
    write_recording(tmp_path / "run.wav", recording)
    review(tmp_path / "run.wav", tmp_path / "review.html", classify=False)
    segment = Segment("all", 0.0, SECONDS, "none", {"none": 1.0}, None, 70.0, -20.0)
    entry = ReportEntry("run", recording, segment)
    write_report(tmp_path / "report.html", [entry], title="Run")
    for page in ("review.html", "report.html"):
        text = (tmp_path / page).read_text(encoding="utf-8")
        assert text.count('<svg class="level"') == 1
