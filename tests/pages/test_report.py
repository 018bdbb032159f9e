from __future__ import annotations

import base64
import io
import re
from html.parser import HTMLParser

import numpy as np
import pytest
import soundfile

from models.condition import Condition
from models.errors import ParameterError, RecordingError
from models.recording import Channel, Recording
from noise.labels.segments import Segment
from noise.pages.report import ReportEntry, write_report

RATE = 30_000
TIME = np.arange(RATE) / RATE
SHARES = {"creak": 0.02, "squawk": 0.05, "squeal": 0.9, "none": 0.026, "unknown": 0.004}


def recording(condition=None, *, calibrated=True, **channels):
    names = tuple(Channel(name) for name in channels)
    samples = np.stack([np.broadcast_to(signal, RATE) for signal in channels.values()])
    return Recording(samples, RATE, names, condition or Condition(), calibrated)


def segment(
    label="squeal", *, channel="all", frequency=1046.0, level=91.0, dbfs=-3.0, weighted=None
):
    return Segment(channel, 0.0, 1.0, label, SHARES, frequency, level, dbfs, weighted)


def sound(signal, *, rate=RATE, form="WAV", subtype="FLOAT"):
    content = io.BytesIO()
    soundfile.write(content, signal, rate, format=form, subtype=subtype)
    return content.getvalue()


TONE = np.sin(2.0 * np.pi * 1046.0 * TIME)
RIG = recording(
    Condition(10.0, 0.279e-3, 3745.0, "fluorocarbon", 23.0),
    pressure=TONE,
)


class Page(HTMLParser):
    """What a page consists of: tags with their attributes, and text by the tag around it."""

    def __init__(self, html):
        super().__init__()
        self.html = html
        self.tags = []
        self.texts = []
        self._open = []
        self.feed(html)

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        self._open.append(tag)

    def handle_data(self, data):
        if data.strip():
            self.texts.append((self._open[-1] if self._open else "", data.strip()))

    def all(self, tag):
        return [attributes for name, attributes in self.tags if name == tag]

    def text(self, tag):
        return [text for name, text in self.texts if name == tag]

    @property
    def panels(self):
        return [a for a in self.all("img") if a.get("src", "").startswith("data:image/svg")]

    @property
    def sound(self):
        content = re.search(r'id="sound-s1"[^>]*>(.*?)</script>', self.html, re.S)[1]
        return io.BytesIO(base64.b64decode(content))


@pytest.fixture
def write(tmp_path):
    def written(*entries, **options):
        path = tmp_path / "report.html"
        write_report(path, entries, title="Review", **options)
        return Page(path.read_text(encoding="utf-8"))

    return written


def test_conditions_level_and_frequency_are_in_the_units_of_the_page(write):
    page = write(ReportEntry("Squeal", RIG, segment(weighted=91.2)))
    overview, known = page.text("td")[:6], page.text("td")[6:14]
    assert overview == [
        "10 rad/s",
        "0.279 mm",
        "3745 Nm/rad",
        "fluorocarbon",
        "91.2 dB(A)",
        "1046 Hz",
    ]
    assert known[:5] == [*overview[:4], "23 °C"]
    assert known[5:7] == ["91.2 dB(A) re 20 µPa", "1046 Hz"]


def test_what_is_not_known_is_said_to_be(write):
    old = recording(pressure=TONE, calibrated=False)
    page = write(ReportEntry("Old file", old, segment(frequency=None, level=None, dbfs=-23.2)))
    assert page.text("td").count("not known") == 5
    assert "\N{MINUS SIGN}23.2 dBFS" in page.text("td")


@pytest.mark.parametrize(
    ("form", "subtype"), [("WAV", "FLOAT"), ("FLAC", "PCM_16"), ("WAV", "PCM_24")]
)
def test_any_sound_is_played_as_16_bit_flac(write, tmp_path, form, subtype):
    file = tmp_path / "sound"
    file.write_bytes(sound(0.5 * TONE, form=form, subtype=subtype))
    page = write(ReportEntry("Squeal", RIG, segment(), file))
    with soundfile.SoundFile(page.sound) as played:
        assert (played.format, played.subtype, played.samplerate) == ("FLAC", "PCM_16", RATE)
        assert played.read() == pytest.approx(0.5 * TONE, abs=2.0**-15)


def test_the_gain_is_stated_and_whether_it_is_common(write):
    def gain(*full_scales):
        page = write(
            *(ReportEntry("s", RIG, segment(), sound(TONE), full_scale=f) for f in full_scales)
        )
        return next(text for text in page.text("p") if "sounds" in text.lower())

    same = (
        "Sounds: full scale = 2 Pa (100 dB peak re 20 µPa), the same for all sounds on this page."
    )
    assert gain(2.0, 2.0) == same
    assert "different gains" in gain(2.0, 4.0)
    assert "different gains" in gain(2.0, None)
    assert "not stated" in gain(None, None)


@pytest.mark.parametrize(
    ("audio", "error", "message"),
    [
        (sound(1.01 * TONE), ParameterError, "clipped"),
        (sound(np.full(64, np.nan)), ParameterError, "clipped"),
        (b"no sound", RecordingError, "damaged"),
        (b"", RecordingError, "damaged"),
    ],
)
def test_a_sound_that_cannot_be_played_leaves_the_old_page(tmp_path, audio, error, message):
    path = tmp_path / "report.html"
    path.write_text("old")
    with pytest.raises(error, match=message):
        write_report(path, [ReportEntry("Squeal", RIG, segment(), audio)], title="Review")
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_report_of_nothing_is_refused(tmp_path):
    with pytest.raises(ParameterError, match="no entry"):
        write_report(tmp_path / "report.html", [], title="Review")
