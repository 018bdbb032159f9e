"""The thesis's figures, drawn again: which there are, and that they show what they say."""

import numpy as np
import pytest
from matplotlib.figure import Figure

import noise
from features.kernels.spectra import autospectrum
from models.condition import FIXED
from models.radiation.rig_response import impulse_responses
from noise.cli import main
from noise.pictures import thesis
from noise.thesis.runs import CALIBRATED, LONG, SHORT, Case, rig_of


def checked(figure, recwarn):
    figure.draw_without_rendering()
    assert not [str(one.message) for one in recwarn]
    labels = [axes.get_xlabel() for axes in figure.axes if axes.get_xlabel()]
    assert labels
    assert all("[" in label for label in labels)
    assert all(axes.lines for axes in figure.axes)
    return figure


def test_pictures_are_named_and_titled_by_their_figures(monkeypatch, recwarn):
    few = {"6.4-6.6": thesis.RUNS["6.4-6.6"], "6.10": thesis.RUNS["6.10"]}
    for name, entries in (("RUNS", few), ("SPECTRA", {}), ("SWEEPS", {})):
        monkeypatch.setattr(thesis, name, entries)
    drawn = dict(thesis.thesis_pictures())
    assert [*drawn] == [f"figure-{n}" for n in ("6.4-6.6", "6.10a", "6.10b", "6.10c", "H1")]
    title = checked(drawn["figure-6.4-6.6"], recwarn).get_suptitle()
    assert title == "Figure 6.4-6.6: fluorocarbon-thesis, 0.279 mm, 2214 Nm/rad, 10 rad/s"


def test_spectra_are_those_of_the_recorded_torque(recwarn):
    shown = thesis.Runs("fluorocarbon-thesis", [Case(1.0, 0.279, FIXED), Case(10.0)], 0.3)
    figure = checked(thesis.torque_spectra("5.14", shown), recwarn)
    rig = noise.load_material_rig("fluorocarbon-thesis")
    recording = noise.simulate(rig, 1.0, support_stiffness=FIXED, seconds=0.3).recording
    expected = 10.0 * np.log10(autospectrum(recording["torque"], recording.rate).density)
    assert figure.axes[0].lines[0].get_ydata().max() == pytest.approx(expected[1:].max(), abs=0.1)
    assert figure.axes[0].get_title("left") == "0.279 mm, fixed clamp, 1 rad/s"


def test_acoustic_responses_are_those_of_the_rig(recwarn):
    rig = rig_of(CALIBRATED)
    figure = checked(thesis.acoustic_responses(), recwarn)
    for axes, support in zip(figure.axes, (LONG, SHORT, FIXED), strict=True):
        frequency, size = axes.lines[0].get_data()
        response = impulse_responses(rig, 0.279e-3, support, 96e3).torque_to_pressure
        at = frequency.size // 5
        line = response @ np.exp(-2j * np.pi * frequency[at] * np.arange(response.size) / 96e3)
        assert size[at] == pytest.approx(abs(line), rel=1e-6)


def test_the_command_writes_the_pictures_and_no_table(tmp_path, capsys, monkeypatch):
    few = {name: Figure(figsize=(2, 2)) for name in ("figure-5.3", "figure-6.7")}
    monkeypatch.setattr(thesis, "thesis_pictures", lambda: iter(few.items()))
    assert main(["thesis", "--plots", str(tmp_path / "new")]) == 0
    expected = [tmp_path / "new" / f"{name}.png" for name in few]
    assert capsys.readouterr().out.splitlines() == [str(path) for path in expected]
    assert sorted((tmp_path / "new").iterdir()) == sorted(expected)


def test_a_file_for_a_folder_is_refused_before_the_work(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(thesis, "thesis_pictures", None)
    (tmp_path / "file").write_text("", encoding="utf-8")
    for place in (tmp_path / "file", tmp_path / "file" / "folder"):
        assert main(["thesis", "--plots", str(place)]) == 2
        (told,) = capsys.readouterr().err.splitlines()
        assert f"error: --plots {place}" in told or "is a file, not a folder" in told
