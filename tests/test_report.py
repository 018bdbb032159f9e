from __future__ import annotations

import base64
import io
import re
import subprocess
import sys
import warnings
from html.parser import HTMLParser
from xml.etree import ElementTree

import matplotlib as mpl
import numpy as np
import pytest
import soundfile
from hypothesis import given
from hypothesis import strategies as st

from models.condition import FIXED, Condition
from models.errors import ParameterError, RecordingError
from models.recording import Channel, Recording
from noise import figures
from noise.figures import entry_figures
from noise.report import ReportEntry, write_report
from noise.segments import Segment
from noise.traces import common_scales, traces

RATE = 30_000
TIME = np.arange(RATE) / RATE
SAWTOOTH = 2.0 * (80.0 * TIME % 1.0) - 1.0
SHARES = {"creak": 0.02, "squawk": 0.05, "squeal": 0.9, "none": 0.026, "unknown": 0.004}


def recording(condition=None, *, calibrated=True, **channels):
    names = tuple(Channel(name) for name in channels)
    samples = np.stack([np.broadcast_to(signal, RATE) for signal in channels.values()])
    return Recording(samples, RATE, names, condition or Condition(), calibrated)


def segment(label="squeal", *, channel="all", frequency=1046.0, level=91.0, dbfs=-3.0):
    return Segment(channel, 0.0, 1.0, label, SHARES, frequency, level, dbfs)


def sound(signal, *, rate=RATE, form="WAV", subtype="FLOAT"):
    content = io.BytesIO()
    soundfile.write(content, signal, rate, format=form, subtype=subtype)
    return content.getvalue()


TONE = np.sin(2.0 * np.pi * 1046.0 * TIME)
RIG = recording(
    Condition(10.0, 0.279e-3, 3745.0, "fluorocarbon", 23.0),
    torque=8.0 + TONE,
    acceleration=90.0 * TONE,
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


@pytest.fixture
def write(tmp_path):
    def written(*entries, **options):
        path = tmp_path / "report.html"
        write_report(path, entries, title="Review", **options)
        return Page(path.read_text(encoding="utf-8"))

    return written


def test_the_page_refers_to_nothing_outside_itself(write):
    page = write(ReportEntry("Squeal", RIG, segment(), sound(TONE)))
    assert not re.search(r"https?:|@import|url\(", page.html)
    references = [a[key] for _, a in page.tags for key in ("src", "href") if key in a]
    assert len(references) == 8
    assert all(reference.startswith(("data:", "#")) for reference in references)


def test_the_page_tells_language_heading_and_meaning_of_everything(write):
    page = write(ReportEntry("Squeal", RIG, segment(), sound(TONE)), summary="It squeals.")
    assert page.all("html") == [{"lang": "en"}]
    assert page.text("h1") == ["Review"]
    assert "It squeals." in page.text("p")
    assert {a["scope"] for a in page.all("th")} == {"col", "row"}
    assert len({a["alt"] for a in page.all("img")}) == len(page.all("img")) == 6
    assert page.all("audio")[0]["aria-label"] == "Sound of Squeal"


def test_without_a_summary_the_labels_are_counted(write):
    page = write(
        ReportEntry("a", RIG, segment()),
        ReportEntry("b", RIG, segment("none")),
        ReportEntry("c", RIG, segment()),
    )
    assert "3 recordings: 2 squeal, 1 none." in page.text("p")


def test_conditions_level_and_frequency_are_in_the_units_of_the_page(write):
    page = write(ReportEntry("Squeal", RIG, segment()))
    cells = page.text("td")
    assert cells[:6] == ["10", "0.279", "3745", "fluorocarbon", "91.0", "1046"]
    shown = page.text("dd")
    assert shown[:5] == ["10 rad/s", "0.279 mm", "3745 Nm/rad", "fluorocarbon", "23 °C"]
    assert shown[5:] == ["91.0 dB re 20 µPa", "1046 Hz"]


def test_what_is_not_known_is_said_to_be(write):
    page = write(
        ReportEntry(
            "Old file",
            recording(pressure=TONE, calibrated=False),
            segment(frequency=None, level=None, dbfs=-23.2),
        )
    )
    assert page.text("span").count("not known") == 5
    assert "−23.2 dBFS" in page.text("dd")


def test_a_speed_that_varied_is_given_by_its_range(write):
    varied = recording(Condition(support_stiffness=FIXED), pressure=TONE, speed=10.0 * TIME)
    page = write(ReportEntry("Ramp", varied, segment()))
    assert page.text("dd")[:1] == ["0 to 10 rad/s"]
    assert "fixed" in page.text("dd")


def test_probabilities_are_bars_with_their_number(write):
    page = write(ReportEntry("Squeal", RIG, segment()))
    widths = [a["style"] for a in page.all("span") if a.get("class") == "bar"]
    assert widths == [f"width: {width}%" for width in ("2.0", "5.0", "90.0", "2.6", "0.4")]
    assert page.text("td")[-5:] == ["2 %", "5 %", "90 %", "3 %", "< 1 %"]


@pytest.mark.parametrize(
    "title", ['<script>alert(1)</script>"', "</h2><img src=x onerror=alert(1)>", "a & b {{ 1 }}"]
)
def test_a_title_stays_text(write, title):
    page = write(ReportEntry(title, RIG, segment(), sound(TONE), note=title))
    assert len(page.all("script")) == 1
    assert len(page.all("img")) == 6
    assert "".join(page.text("h2")) == title
    assert page.all("audio")[0]["aria-label"] == f"Sound of {title}"


def test_a_name_that_no_utf_8_can_hold_is_written_escaped(write):
    page = write(ReportEntry("run\udcff.wav", RIG, segment()))
    assert page.text("h2") == ["run\\udcff.wav"]


@pytest.mark.parametrize(
    ("form", "subtype"), [("WAV", "FLOAT"), ("FLAC", "PCM_16"), ("WAV", "PCM_24")]
)
def test_any_sound_is_played_as_16_bit_wav(write, tmp_path, form, subtype):
    file = tmp_path / "sound"
    file.write_bytes(sound(0.5 * TONE, form=form, subtype=subtype))
    page = write(ReportEntry("Squeal", RIG, segment(), file))
    head, _, content = page.all("audio")[0]["src"].partition(",")
    assert head == "data:audio/wav;base64"
    with soundfile.SoundFile(io.BytesIO(base64.b64decode(content))) as played:
        assert (played.format, played.subtype, played.samplerate) == ("WAV", "PCM_16", RATE)
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


def test_a_sound_that_is_missing_is_named(tmp_path):
    missing = ReportEntry("Squeal", RIG, segment(), tmp_path / "gone.wav")
    with pytest.raises(RecordingError, match=r"gone\.wav"):
        write_report(tmp_path / "report.html", [missing], title="Review")


def test_a_report_of_nothing_is_refused(tmp_path):
    with pytest.raises(ParameterError, match="no entry"):
        write_report(tmp_path / "report.html", [], title="Review")


def test_the_same_recordings_give_the_same_bytes(write):
    entry = ReportEntry("Squeal", RIG, segment(), sound(TONE))
    assert write(entry).html == write(entry).html


def test_four_noisy_recordings_of_two_seconds_stay_below_three_megabytes(write):
    rng = np.random.default_rng(0)
    noise = rng.normal(size=(3, 2 * RATE))
    channels = (Channel("torque"), Channel("acceleration"), Channel("pressure"))
    audio = sound(0.1 * rng.normal(size=2 * 48_000), rate=48_000)
    hiss = ReportEntry("Hiss", Recording(noise, RATE, channels), segment(), audio)
    assert len(write(hiss, hiss, hiss, hiss).html) < 3e6


@pytest.mark.parametrize(
    ("channels", "kinds"),
    [
        ({"pressure": TONE}, ["pressure"]),
        ({"angle": TIME, "acceleration": TONE, "torque": TONE}, ["torque", "acceleration"]),
        ({"angle": TIME}, []),
    ],
)
def test_only_the_channels_there_are_are_shown(write, channels, kinds):
    entry = ReportEntry("Partial", recording(**channels), segment())
    (figure,) = entry_figures([(entry.recording, entry.segment)])
    assert [row.kind for row in figure.rows] == kinds
    page = write(entry)
    assert len(page.all("img")) == 2 * len(kinds)
    assert bool(kinds) != ("no channel" in page.text("figcaption")[0])


def test_constant_and_silent_recordings_are_drawn_without_a_warning(write):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        write(
            ReportEntry("Silent", recording(torque=0.0, pressure=0.0), segment()),
            ReportEntry("Constant", recording(torque=8.1, acceleration=-3.0), segment()),
            ReportEntry("Digital zero", recording(pressure=0.0, calibrated=False), segment()),
        )


def test_a_recording_shorter_than_the_window_is_shown_whole():
    short = Recording(TONE[None, :600], RATE, (Channel("pressure"),))
    (trace,) = traces(short, segment(), 0.05)
    assert (trace.start, trace.samples.size) == (0.0, 600)


def test_the_time_history_is_from_the_middle_of_the_segment():
    late = Segment("all", 0.6, 1.0, "squeal", SHARES, None, None, None)
    (trace,) = traces(recording(pressure=TIME), late, 0.05)
    assert trace.samples[[0, -1]] == pytest.approx([0.775, 0.825], abs=1e-4)
    assert trace.analysed == pytest.approx((0.6, 1.0))


def test_a_segment_of_one_track_shows_that_track():
    both = recording(pressure=TONE, pressure_2=2.0 * TONE)
    (trace,) = traces(both, segment(channel="2"), 0.05)
    assert np.abs(trace.samples).max() == pytest.approx(2.0, rel=1e-3)


def test_a_spectrum_reads_the_level_of_a_known_density():
    noise = np.random.default_rng(3).normal(size=RATE)
    (trace,) = traces(recording(pressure=noise), segment(), 0.05)
    _, levels = trace.levels
    expected = 10.0 * np.log10(1.0 / (RATE / 2.0) / 20e-6**2)
    assert 10.0 * np.log10(np.mean(10.0 ** (levels / 10.0))) == pytest.approx(expected, abs=0.2)


def test_recordings_of_one_page_share_the_scale_of_their_spectra():
    loud, quiet = recording(pressure=TONE), recording(pressure=1e-3 * TONE)
    together = common_scales(t for r in (loud, quiet) for t in traces(r, segment(), 0.05))
    alone = common_scales(traces(loud, segment(), 0.05))
    assert together == alone


def test_thinning_keeps_every_peak():
    position = np.linspace(0.0, 1.0, 20_000)
    spikes = np.zeros(20_000)
    spikes[137::613] = 1.0
    _, kept = figures._thinned(position, position, spikes)
    assert kept.size < 2000
    assert np.count_nonzero(kept) == np.count_nonzero(spikes)


@given(st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=4000))
def test_thinning_keeps_ends_order_and_extremes(values):
    y = np.array(values)
    x = np.arange(y.size, dtype=float)
    kept_x, kept_y = figures._thinned(x, x, y)
    assert np.all(np.diff(kept_x) > 0)
    assert (kept_x[0], kept_x[-1]) == (x[0], x[-1])
    assert (kept_y.min(), kept_y.max()) == (y.min(), y.max())


@pytest.mark.parametrize("amplitude", [1e-7, 3e-4, 0.03, 0.3, 0.7, 8.0, 1040.0, 30_000.0])
@pytest.mark.parametrize("calibrated", [True, False])
def test_no_writing_on_a_panel_overlaps_or_is_cut_off(monkeypatch, amplitude, calibrated):
    drawn = []
    monkeypatch.setattr(figures, "_svg", lambda figure: drawn.append(figure) or b"")
    loud = recording(
        torque=amplitude * TONE - 36.9,
        acceleration=amplitude * TONE,
        pressure=amplitude * SAWTOOTH,
        calibrated=calibrated,
    )
    quiet = recording(torque=8.0, acceleration=0.0, pressure=0.0, calibrated=calibrated)
    entry_figures([(loud, segment()), (quiet, segment())])
    assert len(drawn) == 12
    for figure in drawn:
        with mpl.style.context(["default", figures._STYLE]):
            figure.draw_without_rendering()
            (axes,) = figure.axes
            label, tight = axes.yaxis.label.get_window_extent(), axes.get_tightbbox()
            ticks = [t.label1 for t in axes.yaxis.get_major_ticks() if t.label1.get_visible()]
            inside = [t for t in ticks if axes.get_ylim()[0] <= t.get_position()[1]]
            assert min(t.get_window_extent().x0 for t in inside) > label.x1
        assert tight.x0 >= -0.5
        assert tight.y0 >= 0
        assert tight.x1 <= figure.bbox.x1
        assert tight.y1 <= figure.bbox.y1


def test_panels_are_sound_svg_files():
    (figure,) = entry_figures([(RIG, segment())])
    for row in figure.rows:
        for panel in (row.time, row.spectrum):
            assert ElementTree.fromstring(panel.svg).tag == "{http://www.w3.org/2000/svg}svg"
            assert panel.alt.endswith(".")


def test_drawing_leaves_the_callers_settings_alone():
    with mpl.rc_context({"font.size": 31.0, "axes.grid": False, "svg.hashsalt": "theirs"}):
        before = dict(mpl.rcParams)
        (figure,) = entry_figures([(RIG, segment())])
        assert dict(mpl.rcParams) == before
    assert entry_figures([(RIG, segment())]) == (figure,)


def test_no_plotting_interface_with_state_is_loaded():
    code = "import sys, noise.report; sys.exit('matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize("window", [0.0, -1.0, float("nan"), float("inf")])
def test_a_window_of_no_length_is_refused(window):
    with pytest.raises(ParameterError, match="window"):
        entry_figures([(RIG, segment())], window=window)


def test_text_stands_out_from_its_ground(write):
    def luminance(colour):
        values = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255.0
        linear = np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
        return float(linear @ [0.2126, 0.7152, 0.0722])

    html = write(ReportEntry("Squeal", RIG, segment())).html
    colours = dict(re.findall(r"--(\w+): (#\w{6});", html))
    (link,) = re.findall(r"a \{ color: (#\w{6});", html)
    for ink in (colours["ink"], colours["soft"], link):
        for ground in ("#ffffff", colours["wash"]):
            ratio = (luminance(ground) + 0.05) / (luminance(ink) + 0.05)
            assert ratio >= 4.5
