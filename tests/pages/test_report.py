"""The report: what is said of each recording, and the sounds at one gain."""

from __future__ import annotations

import base64
import io
import re

import numpy as np
import pytest
import soundfile

from models.condition import Condition
from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.labels.segments import Segment
from noise.pages.report import ReportEntry, write_report

RATE = 30_000
TONE = np.sin(2.0 * np.pi * 1046.0 * np.arange(RATE) / RATE)
SHARES = {"creak": 0.02, "squawk": 0.05, "squeal": 0.9, "none": 0.026, "unknown": 0.004}
RIG = Condition(10.0, 0.279e-3, 3745.0, "fluorocarbon", 23.0)


def entry(title, signal=TONE, condition=RIG, *, calibrated=True, frequency=1046.0, level=91.0):
    recording = Recording(signal[None], RATE, (Channel("pressure"),), condition, calibrated)
    segment = Segment("all", 0.0, 1.0, "squeal", SHARES, frequency, level, -23.2, level)
    return ReportEntry(title, recording, segment, "remarkable")


@pytest.fixture
def write(tmp_path):
    def written(*entries):
        path = tmp_path / "report.html"
        write_report(path, entries, title="Review")
        return path.read_text(encoding="utf-8")

    return written


def cells(page):
    return [re.sub(r"<.*?>", "", one) for one in re.findall(r"<td.*?>(.*?)</td>", page)]


def test_conditions_level_and_frequency_are_in_the_units_of_the_page(write):
    page = write(entry("Squeal"), entry("Old", condition=Condition(), calibrated=False, level=None))
    first, second = cells(page)[:7], cells(page)[7:]
    conditions = ["10 rad/s", "0.279 mm", "3745 Nm/rad", "fluorocarbon"]
    assert first[1:] == [*conditions, "91.0 dB(A)", "1046 Hz"]
    assert second[5:] == ["\N{MINUS SIGN}23.2 dBFS", "1046 Hz"]
    assert page.count("remarkable") == 2
    assert page.count("data:image/svg") == 4
    assert "not calibrated" in page


def test_calibrated_sounds_share_one_gain_that_is_stated(write):
    page = write(entry("Loud"), entry("Soft", 0.5 * TONE))
    assert "full scale = 1.00" in page
    found = re.findall(r'id="sound-s\d" data-full-scale="(.*?)">(.*?)</script>', page, re.S)
    assert len({scale for scale, _ in found}) == 1
    loud, soft = (soundfile.read(io.BytesIO(base64.b64decode(flac)))[0] for _, flac in found)
    np.testing.assert_allclose(soft, 0.5 * loud, atol=2.0**-15)
    assert np.abs(loud).max() == pytest.approx(1.0, abs=0.01)


def test_a_report_of_nothing_is_refused(tmp_path):
    with pytest.raises(ParameterError, match="no entry"):
        write_report(tmp_path / "report.html", [], title="Review")
