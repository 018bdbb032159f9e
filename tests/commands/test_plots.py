"""What results draw of themselves."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import noise
from features.modal.modes import Modes
from models.errors import ParameterError
from models.recording import Channel, Recording
from models.transfer_functions.transfer_function import TransferFunction
from noise.labels.segments import Segment, Segments
from noise.labels.table import LabelTable
from tests.helpers.made_diagnoses import one_effect


def run():
    return noise.simulate(noise.load_material_rig("fluorocarbon-thesis"), 1.0, seconds=0.2)


def recording(**others):
    time = np.arange(4800) / 48e3
    samples = np.stack([np.sin(300 * time), 2 * np.cos(500 * time)])
    return Recording(samples, 48e3, (Channel("torque"), Channel("pressure")), **others)


def segments():
    creak = Segment("all", 0.0, 1.25, "creak", {"creak": 0.9, "none": 0.1}, 152.0, 78.0, -20.0)
    return Segments([creak])


def label_table():
    row = {"file": "a.wav", "channel": "all", "start_s": 0.0, "end_s": 2.0, "label": "creak"}
    return LabelTable([row])


def frf():
    f = np.linspace(0.0, 200.0, 401)
    response = 1.0 / (100.0**2 - f**2 + 2j * 0.02 * 100.0 * f)
    return TransferFunction(f, response, np.where(f < 20.0, 0.2, 0.99), "N m", "m/s^2", "hits")


def modes():
    one = np.array([100.0, 150.0]), np.array([0.02, 0.01]), np.array([[-1j, -2j]])
    return Modes(*one, np.zeros((1, 4)), np.array([9, 8]), 200.0)


@pytest.mark.parametrize("made", [recording, run, segments, label_table, one_effect, frf, modes])
def test_an_object_draws_on_the_axes_it_is_given_and_names_them(made):
    axes = Figure().subplots()
    assert made().plot(ax=axes) is axes
    assert axes.has_data()
    assert axes.get_xlabel()


def test_a_run_draws_the_stretch_asked_for():
    axes = run().plot(Figure().subplots(), start=0.05, end=0.1)
    for line in axes.lines:
        time = line.get_xdata()
        assert (time[0], time[-1]) == pytest.approx((0.05, 0.1), abs=1e-4)
    with pytest.raises(ParameterError, match=r"hold nothing of a run of 0\.2 s"):
        run().plot(Figure().subplots(), start=0.3, end=0.4)


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


def test_a_recording_draws_its_sound_pressure_unless_another_channel_is_named():
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
