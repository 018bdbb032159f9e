"""What objects show of themselves in a notebook, and what they draw."""

import dataclasses
import os
import subprocess
import sys
from functools import cache
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

import noise
from features.modal.modes import Modes
from models.errors import ParameterError
from models.html_table import MOST_ROWS, html_table
from models.recording import Channel, Recording
from models.transfer_functions.transfer_function import TransferFunction
from noise.inference import Inferred, Interval
from noise.labels.segments import Segment, Segments
from noise.labels.table import LabelTable
from noise.pictures.conditions import LABEL_COLOURS
from sim.shaft import SpeedRamp
from tests.helpers.made_diagnoses import one_effect

HOSTILE = "<script>alert('a')</script>&"


def rig():
    return noise.load_material_rig("fluorocarbon-thesis")


@cache
def run():
    return noise.simulate(rig(), 1.0, seconds=0.2)


@cache
def swept():
    sweep = noise.Sweep(rig(), [5.0, 1.0, 2.5], support_stiffness=[[2214.0], [np.inf]], seconds=0.2)
    return sweep.features()


def recording(**others):
    time = np.arange(4800) / 48e3
    return Recording(
        np.stack([np.sin(300 * time), 2 * np.cos(500 * time)]),
        48e3,
        (Channel("torque"), Channel("pressure")),
        **others,
    )


def segments():
    each = {"creak": 0.9, "none": 0.1}, {"creak": 0.2, "none": 0.8}
    return Segments(
        [
            Segment("all", 0.0, 1.25, "creak", each[0], 152.0, 78.0, -20.0),
            Segment("all", 1.25, 3.0, "none", each[1], None, None, None),
        ]
    )


def label_table():
    rows = [
        {"file": "a.wav", "channel": "all", "start_s": 0.0, "end_s": 2.0, "label": "creak",
         "level_db": 78.0, "speed_rad_s": 4.8, "speed_rad_s_low": 3.9, "speed_rad_s_high": 6.2},
        {"file": HOSTILE, "channel": None, "start_s": None, "end_s": None, "label": None,
         "error": "is empty"},
    ]  # fmt: skip
    return LabelTable(rows)


def frf():
    f = np.linspace(0.0, 200.0, 401)
    response = 1.0 / (100.0**2 - f**2 + 2j * 0.02 * 100.0 * f)
    return TransferFunction(f, response, np.where(f < 20.0, 0.2, 0.99), "N m", "m/s^2", "hits")


def modes():
    return Modes(
        np.array([100.0, 150.0]),
        np.array([0.02, 0.01]),
        np.array([[-1j, -2j]]),
        np.zeros((1, 4)),
        np.array([9, 8]),
        200.0,
    )


def inferred():
    return Inferred(speed=Interval(5.0, 4.0, 6.0))


def sweep():
    return noise.Sweep(rig(), [1.0, 2.0])


@cache
def screening():
    use = noise.Use(speed=(1.0, 5.0, 9.0), interference=(0.279e-3,), support_stiffness=(2214.0,))
    return noise.screen(["PDMS", "fluorocarbon-thesis"], use)


def design():
    return noise.load_design("PDMS")


@cache
def stands():
    return noise.robustness(design(), np.random.default_rng(0), half_width=0.2, samples=64)


DRAWN = (screening, recording, run, swept, segments, label_table, one_effect, frf, modes)
SHOWN = (
    *(made for made in DRAWN if made is not recording),
    design,
    stands,
    sweep,
    noise.load_classifier,
    noise.load_inference,
    inferred,
)


class Outline(HTMLParser):
    """Tags that are open, tables with a caption, and cells a row."""

    def __init__(self, text):
        super().__init__()
        self.open, self.tags, self.widths = [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.open.append(tag)
        self.tags.append(tag)
        if tag == "tr":
            self.widths.append(0)
        if tag in ("td", "th"):
            self.widths[-1] += int(dict(attributes).get("colspan", 1))
        if tag == "th":
            assert dict(attributes)["scope"] in ("row", "col")

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


@pytest.mark.parametrize("made", SHOWN)
def test_an_object_shows_itself_as_captioned_tables_with_header_cells(made):
    outline = Outline(made()._repr_html_())
    assert outline.open == []
    assert outline.tags.count("caption") == outline.tags.count("table") > 0
    assert outline.tags.count("th") > 0
    assert set(outline.tags) <= {"table", "caption", "thead", "tbody", "tr", "th", "td"}


@pytest.mark.parametrize("made", DRAWN)
def test_an_object_draws_on_the_axes_it_is_given_and_names_them(made):
    axes = Figure().subplots()
    assert made().plot(ax=axes) is axes
    assert axes.has_data()
    assert axes.get_xlabel()


@pytest.mark.parametrize("made", SHOWN)
def test_rows_of_a_table_are_of_one_width(made):
    for table in made()._repr_html_().split("</table>")[:-1]:
        assert len(set(Outline(table + "</table>").widths)) == 1


def test_text_of_the_user_is_escaped():
    for shown in (label_table(), dataclasses.replace(frf(), name=HOSTILE)):
        html = shown._repr_html_()
        assert "<script" not in html
        assert "&lt;script&gt;" in html


def test_a_long_table_tells_how_much_it_leaves_out():
    rows = [[str(number), "x"] for number in range(MOST_ROWS + 7)]
    assert "and 7 more" in html_table("numbers", rows)
    assert "more" not in html_table("numbers", rows[:MOST_ROWS])


def test_without_axes_a_new_figure_of_pyplot_is_drawn_on_and_settings_stay():
    code = (
        "import sys, numpy as np, noise\n"
        "tone = noise.Recording(np.zeros((1, 480)), 48e3, (noise.Channel('pressure'),))\n"
        "repr(tone)\n"
        "assert 'matplotlib' not in sys.modules\n"
        "import matplotlib as mpl\n"
        "before = dict(mpl.rcParams)\n"
        "axes = tone.plot()\n"
        "import matplotlib.pyplot as plt\n"
        "assert plt.get_fignums() == [axes.figure.number]\n"
        "assert {k: v for k, v in mpl.rcParams.items() if k != 'backend'} == "
        "{k: v for k, v in before.items() if k != 'backend'}\n"
    )
    environment = os.environ | {"MPLBACKEND": "Agg", "PYTHONPATH": str(Path(__file__).parents[2])}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_a_recording_draws_its_sound_pressure_unless_told_otherwise():
    drawn = recording().plot(ax=Figure().subplots())
    assert drawn.get_ylabel() == "Sound pressure [Pa]"
    assert np.ptp(drawn.lines[0].get_ydata()) > 3.9
    assert recording().plot("torque", Figure().subplots()).get_ylabel() == "Torque [Nm]"
    uncalibrated = recording(calibrated=False).plot(ax=Figure().subplots())
    assert uncalibrated.get_ylabel() == "Sound pressure [full scale]"
    with pytest.raises(ParameterError, match="no channel 'force'"):
        recording().plot("force", Figure().subplots())
    empty = Recording(np.zeros((1, 0)), 48e3, (Channel("pressure"),), name="empty.wav")
    with pytest.raises(ParameterError, match=r"'empty\.wav' holds nothing"):
        empty.plot(ax=Figure().subplots())


def test_a_run_draws_the_stretch_asked_for():
    axes = run().plot(Figure().subplots(), start=0.05, end=0.1)
    for line in axes.lines:
        time = line.get_xdata()
        assert time[0] == pytest.approx(0.05, abs=1e-4)
        assert time[-1] == pytest.approx(0.1, abs=1e-4)
    assert run().plot(Figure().subplots()).lines[0].get_xdata()[0] == pytest.approx(0.1, abs=1e-4)
    with pytest.raises(ParameterError, match=r"hold nothing of a run of 0\.2 s"):
        run().plot(Figure().subplots(), start=0.3, end=0.4)


def test_a_sweep_draws_one_curve_a_support_over_rising_speeds():
    axes = swept().plot("torque_mean", Figure().subplots())
    assert [line.get_label() for line in axes.lines] == ["2214 Nm/rad", "clamp fixed"]
    for line, row in zip(axes.lines, swept()["torque_mean"], strict=True):
        assert line.get_xdata().tolist() == [1.0, 2.5, 5.0]
        assert line.get_ydata().tolist() == row[[1, 2, 0]].tolist()
    with pytest.raises(ParameterError, match="feature 'loudness' is not known"):
        swept().plot("loudness", Figure().subplots())


def test_a_sweep_over_ramps_is_shown_but_has_no_axis_of_speeds():
    found = noise.Sweep(rig(), SpeedRamp(0.0, 5.0, 0.1), seconds=0.1).features()
    assert "SpeedRamp" in found._repr_html_()
    with pytest.raises(ParameterError, match="draw constant ones"):
        found.plot(ax=Figure().subplots())


def test_features_of_a_sweep_are_the_dictionary_that_programs_take():
    assert isinstance(swept(), dict)
    assert swept()["slip_frequency"].shape == (2, 3)


def test_labels_are_bars_in_their_colours():
    axes = segments().plot(Figure().subplots())
    bars = {to_hex(bar.get_facecolor()[0]): bar.get_paths()[0] for bar in axes.collections}
    assert set(bars) == {LABEL_COLOURS["creak"], LABEL_COLOURS["none"]}
    assert bars[LABEL_COLOURS["creak"]].get_extents().width == pytest.approx(1.25)
    with pytest.raises(ParameterError, match="nothing is labelled"):
        Segments().plot(Figure().subplots())


def test_segments_are_the_list_that_programs_take():
    assert isinstance(segments(), list)
    assert segments() == list(segments())
    assert noise.file_label(segments()).label == "creak"


def test_a_label_table_draws_what_was_labelled_and_tells_what_was_refused():
    table = label_table()
    axes = table.plot(Figure().subplots())
    assert [tick.get_text() for tick in axes.get_yticklabels()] == ["a.wav"]
    assert table.refused == {HOSTILE: "is empty"}
    assert "4.8 rad/s (3.9 to 6.2)" in table._repr_html_()


def test_causes_of_the_verdict_stand_out():
    axes = one_effect().plot(Figure().subplots())
    colours = {
        tick.get_text(): to_hex(bar.get_facecolor())
        for tick, bar in zip(axes.get_yticklabels(), axes.patches, strict=True)
    }
    assert colours.pop("partial slip") not in set(colours.values())
    assert "partial slip" in one_effect()._repr_html_()


def test_modes_are_drawn_upon_the_response_they_were_fitted_to():
    axes = frf().plot(Figure().subplots())
    name = axes.get_ylabel()
    assert isinstance(modes().plot(axes), Axes)
    assert axes.get_ylabel() == name == "Magnitude [m/s^2 per N m]"
    labels = axes.get_legend_handles_labels()[1]
    assert labels == ["hits, coherence of 0.5 or more", "modes"]
    few = Modes(*(np.zeros(0), np.zeros(0), np.zeros((1, 0)), np.zeros((1, 4)), np.zeros(0), 9.0))
    with pytest.raises(ParameterError, match="no mode"):
        few.plot(Figure().subplots())


def test_labelling_files_in_one_call_gives_the_table_of_the_command(tmp_path):
    noise.write_recording(tmp_path / "silent", noise.simulate(noise.load_material_rig("PDMS"), 5.0)
                          .recording)  # fmt: skip
    (tmp_path / "empty.wav").write_bytes(b"")
    table = noise.label(tmp_path)
    assert [(row["file"], row["label"]) for row in table] == [
        ("empty.wav", None),
        ("silent.wav", "none"),
    ]
    assert list(table.refused) == ["empty.wav"]
    table.write(tmp_path / "labels.csv")
    from noise.cli import main

    assert main(["label", str(tmp_path), "--out", str(tmp_path / "again.csv")]) == 1
    assert (tmp_path / "labels.csv").read_bytes() == (tmp_path / "again.csv").read_bytes()
    with pytest.raises(ParameterError, match="workers = 0"):
        noise.label(tmp_path, workers=0)
    with pytest.raises(ParameterError, match="tables end in"):
        noise.label(tmp_path, out=tmp_path / "labels.ods")
