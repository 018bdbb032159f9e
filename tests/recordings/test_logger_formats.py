"""TDMS, MDF4 and HDF5 as recordings: what is true of all three."""

from __future__ import annotations

import subprocess
import sys

import h5py
import numpy as np
import pytest
from asammdf import MDF, Signal
from nptdms import ChannelObject, TdmsWriter

from models.condition import FIXED
from models.errors import RecordingError
from noise.recordings import find_recordings, read_recording
from tests.helpers.logger_files import WRITERS, Wave

X = np.sin(0.01 * np.arange(4000))


@pytest.fixture(params=WRITERS)
def write(request, tmp_path):
    def writer(*waves, conditions=None):
        path = tmp_path / f"run{request.param}"
        return WRITERS[request.param](path, list(waves), conditions)

    return writer


def refusal(path):
    with pytest.raises(RecordingError) as refused:
        read_recording(path)
    message = str(refused.value)
    assert "\n" not in message
    assert message.startswith(str(path))
    return message


def test_channels_are_named_by_their_units_and_brought_to_si(write):
    waves = {
        "Arm": ("N mm", "torque", 1e-3),
        "Clamp z": ("g", "acceleration", 9.80665),
        "Mic 1": ("mPa", "pressure", 1e-3),
        "Encoder": ("deg", "angle", np.pi / 180),
        "Drive": ("rpm", "speed", np.pi / 30),
        "Load": ("kN", "force", 1e3),
        "Mic 2": ("Pa", "pressure_2", 1.0),
    }
    path = write(*(Wave(name, unit, X) for name, (unit, _, _) in waves.items()))
    run = read_recording(path)
    assert run.rate == 51200.0
    assert run.calibrated
    assert set(run.channel_names) == {name for _, name, _ in waves.values()}
    for _, name, factor in waves.values():
        np.testing.assert_allclose(run[name], factor * X, rtol=1e-12, atol=1e-15)


def test_without_a_unit_a_name_of_ours_says_what_a_channel_is(write):
    run = read_recording(write(Wave("pressure_2", "", X), Wave("torque", "", 2 * X)))
    assert set(run.channel_names) == {"pressure_2", "torque"}
    np.testing.assert_array_equal(run["torque"], 2 * X)


def test_conditions_come_from_the_properties_of_the_file(write):
    said = {
        "speed_rad_s": 5.0,
        "interference_mm": 0.279,
        "support_stiffness_Nm_rad": "fixed",
        "material": "PDMS",
        "temperature_C": 23.0,
        "operator": "somebody",
    }
    condition = read_recording(write(Wave("m", "Pa", X), conditions=said)).condition
    assert condition.speed == 5.0
    assert condition.interference == pytest.approx(0.279e-3)
    assert condition.support_stiffness == FIXED
    assert condition.material == "PDMS"
    assert condition.temperature == 23.0


def test_a_sidecar_overrides_channels_and_conditions(write):
    said = {"speed_rad_s": 5.0, "material": "PDMS"}
    path = write(Wave("a", "Pa", X), Wave("b", "V", 3 * X), conditions=said)
    path.with_suffix(".json").write_text(
        '{"channels": [{"name": "pressure"}, {"name": "torque"}],'
        ' "conditions": {"speed_rad_s": 2.5}}'
    )
    run = read_recording(path)
    np.testing.assert_array_equal(run["torque"], 3 * X)
    assert (run.condition.speed, run.condition.material) == (2.5, "PDMS")


def test_what_is_none_of_ours_is_passed_over_at_any_rate(write):
    slow = Wave("oil", "degC", X[:400], 10.0)
    run = read_recording(write(Wave("volts", "V", X), Wave("mic", "Pa", 2 * X), slow))
    assert run.channel_names == ("pressure",)
    np.testing.assert_array_equal(run["pressure"], 2 * X)


@pytest.mark.parametrize(
    ("waves", "message"),
    [
        ([Wave("torque", "V", X)], "channel 'torque' has unit 'V', expected 'N m'"),
        ([Wave("torque", "Pa", X)], "channel 'torque' has unit 'Pa', expected 'N m'"),
        (
            [Wave("mic", "V", X)],
            "'mic' has unit 'V'; expected samples over time in one of N m",
        ),
        ([Wave("a", "Pa", X), Wave("b", "Pa", X[:900])], "must be sampled together"),
        ([Wave("a", "Pa", X), Wave("b", "Pa", X, 25600.0)], "must be sampled together"),
        ([Wave("a", "Pa", np.full(99, np.nan))], "channel 'pressure' is nan at sample 0"),
    ],
)
def test_what_contradicts_itself_is_refused_in_one_line(write, waves, message):
    assert message in refusal(write(*waves))


def test_a_condition_that_is_none_names_its_field(write):
    path = write(Wave("mic", "Pa", X), conditions={"speed_rad_s": "fast"})
    assert "speed_rad_s = 'fast' must be a number" in refusal(path)


def test_files_are_found_by_their_ending(write, tmp_path):
    path = write(Wave("mic", "Pa", X))
    assert [found for found, _ in find_recordings(tmp_path)] == [path]


@pytest.mark.parametrize(
    ("ending", "library", "extra"),
    [(".tdms", "nptdms", "tdms"), (".mf4", "asammdf", "mdf"), (".h5", "h5py", "hdf5")],
)
def test_a_missing_library_is_named_with_the_command_that_installs_it(
    tmp_path, monkeypatch, ending, library, extra
):
    monkeypatch.setitem(sys.modules, library, None)
    path = tmp_path / f"run{ending}"
    path.write_bytes(b"anything")
    message = refusal(path)
    assert library in message
    assert message.endswith(f'run: pip install "bushing-noise[{extra}]"')


def test_no_library_of_a_format_is_loaded_before_its_file_turns_up():
    code = (
        "import sys, noise.recordings.files;"
        "assert not {'h5py', 'asammdf', 'nptdms', 'pyuff'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


# --- each for itself -------------------------------------------------------------------------


def test_tdms_time_may_be_a_channel_of_its_own(tmp_path):
    path = tmp_path / "run.tdms"
    time = np.arange(X.size) / 25600
    with TdmsWriter(path) as file:
        file.write_segment([ChannelObject("g", "Time", time), ChannelObject("g", "torque", X)])
        file.write_segment([ChannelObject("g", "Time", time + time[-1] + 1 / 25600)])
        file.write_segment([ChannelObject("g", "torque", X[::-1].copy())])
    run = read_recording(path)
    assert run.rate == 25600.0
    np.testing.assert_array_equal(run["torque"], np.concatenate([X, X[::-1]]))


def test_a_tdms_scale_is_applied_and_an_unknown_one_refused(tmp_path):
    path = tmp_path / "run.tdms"
    scale = {
        "NI_Number_Of_Scales": 1,
        "NI_Scale[0]_Scale_Type": "Linear",
        "NI_Scale[0]_Linear_Slope": 0.5,
        "NI_Scale[0]_Linear_Y_Intercept": 1.0,
        "NI_Scale[0]_Linear_Input_Source": 0xFFFFFFFF,
        "NI_Scaling_Status": "unscaled",
        "wf_increment": 1e-3,
    }
    counts = np.arange(400, dtype=np.int16)
    with TdmsWriter(path) as file:
        file.write_segment([ChannelObject("g", "torque", counts, scale)])
    np.testing.assert_allclose(read_recording(path)["torque"], 1.0 + 0.5 * counts)
    with TdmsWriter(path) as file:
        unknown = scale | {"NI_Scale[0]_Scale_Type": "Magic"}
        file.write_segment([ChannelObject("g", "torque", counts, unknown)])
    assert "scale type 'Magic'" in refusal(path)


def test_mdf_events_that_are_none_of_ours_do_not_matter(tmp_path):
    events = np.cumsum(np.random.default_rng(1).exponential(1.0, 50))
    with MDF(version="4.10") as file:
        file.append([Signal(X[:50], events, unit="degC", name="oil")])
        file.append([Signal(X, np.arange(X.size) / 48e3, unit="Pa", name="mic")])
        path = file.save(tmp_path / "run.mf4")
    run = read_recording(path)
    assert (run.rate, run.channel_names) == (48e3, ("pressure",))


@pytest.mark.parametrize("compression", [0, 1, 2])
def test_packed_mdf_integers_are_converted(tmp_path, compression):
    counts = np.arange(70_000, dtype=np.int16)
    with MDF(version="4.10") as file:
        conversion = {"a": 0.5, "b": 1.0}
        time = np.arange(counts.size) / 48e3
        file.append([Signal(counts, time, unit="Pa", name="mic", conversion=conversion)])
        path = file.save(tmp_path / "run.mf4", compression=compression)
    np.testing.assert_allclose(read_recording(path)["pressure"], 1.0 + 0.5 * counts)


def test_an_older_mdf_file_is_refused_by_its_version(tmp_path):
    with MDF(version="3.30") as file:
        file.append([Signal(X, np.arange(X.size) / 48e3, unit="Pa", name="mic")])
        path = file.save(tmp_path / "run.mdf")
    assert "version '3.30', expected 4" in refusal(path)


def test_hdf5_rate_and_time_may_stand_beside_the_channels(tmp_path):
    for name, rate in (("a.h5", "attribute"), ("b.hdf5", "dataset")):
        with h5py.File(tmp_path / name, "w") as file:
            group = file.create_group("run/first")
            group.create_dataset("torque", data=X, compression="gzip")
            group.create_dataset("picture", data=np.zeros((3, 3)))
            if rate == "attribute":
                file.attrs["dt"] = 1 / 48e3
            else:
                group["time"] = np.arange(X.size) / 48e3
        run = read_recording(tmp_path / name)
        assert (run.rate, run.channel_names) == (48e3, ("torque",))
        np.testing.assert_array_equal(run["torque"], X)


def test_an_hdf5_dataset_that_was_never_written_is_refused(tmp_path):
    path = tmp_path / "run.h5"
    with h5py.File(path, "w") as file:
        file.create_dataset("torque", (10**12,), "f8").attrs["rate"] = 48e3
    assert "announces 1000000000000 samples, of which 0 bytes are stored" in refusal(path)


def test_an_hdf5_dataset_in_another_file_is_not_followed(tmp_path):
    path = tmp_path / "run.h5"
    (tmp_path / "other").write_bytes(bytes(8000))
    with h5py.File(path, "w") as file:
        external = [(str(tmp_path / "other"), 0, 8000)]
        file.create_dataset("torque", (1000,), "f8", external=external).attrs["rate"] = 48e3
    assert "is kept in another file" in refusal(path)
