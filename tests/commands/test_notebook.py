"""What results are in a notebook: a short print, a data frame of pandas, a picture on axes."""

import numpy as np
import pytest
from matplotlib.figure import Figure

import noise
from features.modal.modal_fit import Modes
from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.identification.outcome import Identification, Number
from noise.labels.table import COLUMNS
from tests.helpers.made_diagnoses import one_effect

LONGEST = 500
CHANNELS = (Channel("torque"), Channel("pressure"))


def run():
    return noise.simulate(noise.load_material_rig("fluorocarbon-thesis"), 1.0, seconds=0.2)


def recording(**others):
    time = np.arange(4800) / 48e3
    samples = np.stack([np.sin(300 * time), 2 * np.cos(500 * time)])
    return Recording(samples, 48e3, CHANNELS, **others)


def label_table():
    row = {"file": "a.wav", "channel": "all", "start_s": 0.0, "end_s": 2.0, "label": "creak"}
    return noise.LabelTable([row | {"level_db": 70.0}] * 30)


def modes():
    one = np.array([100.0, 150.0]), np.array([0.02, 0.01]), np.array([-1j, -2j])
    return Modes(*one, np.zeros(4), np.array([9, 8]), 200.0)


def identification():
    number = Number("elastomer_stiffness", "Nm/rad", 665.0, 655.0, 675.0, 6, 0.279e-3)
    return Identification("", (number,), (), "constant", ())


def sweep():
    rig = noise.load_material_rig("PDMS")
    return noise.sweep(rig, [1.0, 5.0], support_stiffness=[[2214.0], [noise.FIXED]], seconds=0.01)


DRAWN = (recording, run, one_effect, sweep)
ROWS = {label_table: 30, sweep: 4,
        identification: 1}  # fmt: skip


@pytest.mark.parametrize("made", [*DRAWN, *ROWS, modes, noise.load_classifier])
def test_a_result_prints_short(made):
    printed = repr(made())
    assert len(printed) < LONGEST
    assert printed.startswith(type(made()).__name__)


@pytest.mark.parametrize("made", DRAWN)
def test_an_object_draws_on_the_axes_it_is_given_and_names_them(made):
    axes = Figure().subplots()
    assert made().plot(ax=axes) is axes
    assert axes.has_data()
    assert axes.get_xlabel()


@pytest.mark.parametrize("made", ROWS)
def test_a_table_is_a_frame_of_as_many_rows(made):
    pytest.importorskip("pandas")
    frame = made().to_pandas()
    assert len(frame) == ROWS[made]
    assert len(set(frame.columns)) == len(frame.columns)


def test_frames_have_the_columns_of_the_files():
    pytest.importorskip("pandas")
    frame = label_table().to_pandas()
    assert tuple(frame.columns) == COLUMNS
    assert frame["level_db"].mean() == 70.0
    frame = sweep().to_pandas()
    assert frame["speed_rad_s"].tolist() == [1.0, 5.0, 1.0, 5.0]
    assert frame["support_stiffness_Nm_rad"].tolist() == [2214.0, 2214.0, "fixed", "fixed"]


def test_a_recording_draws_its_sound_pressure_unless_another_channel_is_named():
    drawn = recording().plot(ax=Figure().subplots())
    assert drawn.get_ylabel() == "Sound pressure [Pa]"
    assert np.ptp(drawn.lines[0].get_ydata()) > 3.9
    assert recording().plot("torque", Figure().subplots()).get_ylabel() == "Torque [Nm]"
    uncalibrated = recording(calibrated=False).plot(ax=Figure().subplots())
    assert uncalibrated.get_ylabel() == "Sound pressure [full scale]"
    with pytest.raises(ParameterError, match="no channel 'force'"):
        recording().plot("force", Figure().subplots())
