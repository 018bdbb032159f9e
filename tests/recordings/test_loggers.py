"""TDMS, MDF4, HDF5 and universal files: what they state is used, or refused with the reason."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import numpy as np
import pytest
import soundfile
from asammdf import Signal

from noise.recordings import read_recording
from noise.recordings.files import names_channels
from tests.helpers.files import refusal
from tests.helpers.logger_files import WRITERS, Wave, hdf5, mdf, tdms, uff

N, RATE = 4800, 48e3
T = np.arange(N) / RATE
X = np.sqrt(2) * np.sin(2 * np.pi * 1000 * T)  # 1 Pa rms
STEP = {"wf_increment": 1 / RATE}
DAY = np.datetime64("2024-01-01T10:00:00", "us")
ENDINGS = {tdms: "tdms", mdf: "mf4", hdf5: "h5", uff: "uff"}


def of(write, *channels, **how):
    """Return what writes a file of some channels into a folder."""
    return lambda folder: write(folder / f"x.{ENDINGS[write]}", *channels, **how)


def clock(times, unit="s", name="Time"):
    return (name, times, {"unit_string": unit, "unit": unit} if unit else {})


def mic(x=X, unit="Pa", name="mic", **properties):
    return (name, x, {"unit_string": unit, "unit": unit, **properties})


def signal(x=X, t=T, unit="Pa", name="mic", **more):
    return Signal(x, t, unit=unit, name=name, **more)


def assert_refused(cases, name, folder):
    make, reason = cases[name]
    assert reason in refusal(make(folder))


# --- the axis: 48 kHz, or refused for a reason that says what stands there ---------------------

AXES = {
    "tdms step": of(tdms, mic(**STEP)),
    "tdms step in ms": of(tdms, mic(wf_increment=1e3 / RATE, wf_xunit_string="ms")),
    "tdms clock in ms": of(tdms, clock(1e3 * T, "ms"), mic()),
    "tdms clock beside a step that nobody set": of(tdms, clock(T), mic(wf_increment=1.0)),
    "mdf in ms": of(mdf, [signal(t=1e3 * T)], unit="ms"),
    "mdf that begins late": of(mdf, [signal(t=T + 17.25)]),
    "hdf5 rate": of(hdf5, mic(fs=RATE)),
    "hdf5 step in ms": of(hdf5, mic(dt=1e3 / RATE, x_unit="ms")),
    "hdf5 time_ms": of(hdf5, mic(), clock(1e3 * T, "", "time_ms")),
    "hdf5 time packed": of(
        hdf5, mic(), ("time", np.arange(N), {"units": "s", "scale_factor": 1 / RATE})
    ),
    "uff in s": of(uff, (X, "Pa"), step=1 / RATE),
}


@pytest.mark.parametrize("name", AXES)
def test_the_sampling_rate_is_what_the_axis_states(name, tmp_path):
    run = read_recording(AXES[name](tmp_path))
    assert (run.rate, run.channel_names) == (RATE, ("pressure",))
    np.testing.assert_allclose(run.samples[0], X, atol=1e-9)


NO_TIME = {
    "tdms spectrum": (
        of(tdms, mic(wf_increment=1.0, wf_xunit_string="Hz")),
        "an axis in 'Hz', expected time",
    ),
    "tdms step that nobody set": (of(tdms, mic(wf_increment=1.0)), "no sampling rate"),
    "tdms clock that contradicts the step": (
        of(tdms, clock(2 * T), mic(**STEP)),
        "rates, 48000 and 24000 Hz",
    ),
    "mdf angle": (
        of(mdf, [signal()], unit="deg", sync=2),
        "an axis of angle in 'deg', expected time",
    ),
    "mdf times that are not even": (of(mdf, [signal(t=T + 1e-3 * (T > 0.05))]), "not rise evenly"),
    "hdf5 rate that the time contradicts": (
        of(hdf5, mic(), clock(2 * T, "", "time"), root={"fs": RATE}),
        "two sampling rates",
    ),
    "hdf5 rate that is none": (of(hdf5, mic(fs=1e-6)), "is 1e-06 Hz, expected 1 Hz to 400 kHz"),
}


@pytest.mark.parametrize("name", NO_TIME)
def test_what_does_not_stand_over_time_is_refused(name, tmp_path):
    assert_refused(NO_TIME, name, tmp_path)


# --- where channels begin: together, or refused -------------------------------------------------

LATE = 96  # samples: 2 ms
A, B = X[: N - LATE], X[LATE:]  # of one signal, the second channel begins 2 ms late
TA, TB = T[: N - LATE], T[LATE:]
TIMES = (clock(TA, "", "one/time"), clock(1e3 * TB, "ms", "two/time"))
PAIR = (mic(A, name="one/mic"), mic(B, name="two/mic"))


def pair(key, first, second, **how):
    return mic(A, name="a", **how, **{key: first}), mic(B, name="b", **how, **{key: second})


STARTS = {
    "tdms offset": of(tdms, *pair("wf_start_offset", 0.0, LATE / RATE, **STEP)),
    "tdms time of day": of(
        tdms, *pair("wf_start_time", DAY, DAY + np.timedelta64(2, "ms"), **STEP)
    ),
    "mdf masters": of(mdf, [signal(A, TA, name="a")], [signal(B, TB, name="b")]),
    "hdf5 times": of(hdf5, *PAIR, *TIMES),
    "hdf5 t0": of(hdf5, *pair("t0", 0.0, LATE / RATE, fs=RATE)),
    "uff abscissa": of(
        uff, (A, "Pa", 15, 0.0, len(A)), (B, "Pa", 15, LATE / RATE, len(B)), step=1 / RATE
    ),
}


@pytest.mark.parametrize("name", STARTS)
def test_channels_that_do_not_begin_together_are_refused(name, tmp_path):
    assert "begins 0.002 s after another" in refusal(STARTS[name](tmp_path))


def begins(*late, n=N):
    """Channels a, b, c that begin so late [s]; the last one has n samples."""
    starts = [{} if one is None else {"wf_start_offset": one} for one in late]
    lengths = [N] * (len(late) - 1) + [n]
    stated = zip("abc"[: len(late)], lengths, starts, strict=True)
    return of(tdms, *(mic(X[:m], name=name, **STEP, **start) for name, m, start in stated))


TOGETHER = "channels of a recording must be sampled together"
APART = {
    "between samples": (begins(0.0, 0.4 / RATE), "'b' begins 8.33333e-06 s after another"),
    "a third as long": (begins(0.0, 0.0, n=N // 3), "have between 1600 and 4800 samples"),
    **{
        f"rates in {ending}": (
            lambda folder, write=write, ending=ending: write(
                folder / f"x{ending}", [Wave("a", "Pa", X), Wave("b", "Pa", X, 25600.0)]
            ),
            TOGETHER,
        )
        for ending, write in WRITERS.items()
    },
}


@pytest.mark.parametrize("name", APART)
def test_channels_that_were_not_sampled_together_are_refused(name, tmp_path):
    assert_refused(APART, name, tmp_path)


# --- the value: 1 Pa rms, or refused ------------------------------------------------------------

COUNTS = np.round(X / 1e-4).astype("i2")
PACKED = {"scale_factor": 1e-4, "add_offset": 0.0}
LINEAR = {
    "NI_Number_Of_Scales": 1,
    "NI_Scale[0]_Scale_Type": "Linear",
    "NI_Scale[0]_Linear_Slope": 1e-4,
    "NI_Scale[0]_Linear_Y_Intercept": 0.0,
    "NI_Scale[0]_Linear_Input_Source": 0xFFFFFFFF,
    "NI_Scaling_Status": "unscaled",
}
TEXT = {"lower_0": 9, "upper_0": 9, "text_0": b"error", "default": b""}

VALUES = {
    "hdf5 packed": of(hdf5, mic(COUNTS, fs=RATE, **PACKED)),
    "hdf5 unit behind the name": of(hdf5, ("Mic [kPa]", X / 1e3, {"fs": RATE})),
    "tdms packed": of(tdms, mic(COUNTS, **STEP, **PACKED)),
    "tdms scale": of(tdms, mic(COUNTS, **STEP, **LINEAR)),
    "mdf conversion": of(mdf, [signal(COUNTS, conversion={"a": 1e-4, "b": 0.0})]),
    **{
        f"tdms in {unit}": of(tdms, mic(X / value, unit, **STEP))
        for unit, value in (("Pascal", 1), ("[Pa]", 1), ("PA", 1), ("N/m^2", 1), ("µPa", 1e-6))
    },
}


@pytest.mark.parametrize("name", VALUES)
def test_values_are_brought_to_si_by_all_that_is_stated(name, tmp_path):
    run = read_recording(VALUES[name](tmp_path))
    assert run.channel_names == ("pressure",)
    np.testing.assert_allclose(run.samples[0], X, atol=1e-4)


UNCLEAR = {
    "a gain of whole numbers": (
        of(hdf5, mic(COUNTS, fs=RATE, gain=20.0)),
        "has gain 20, and does not state how",
    ),
    "a conversion that is partly text": (
        of(mdf, [signal(COUNTS, conversion=TEXT)]),
        "has a conversion of its values to text",
    ),
    "a scale that is not known": (
        of(tdms, mic(COUNTS, **STEP, **LINEAR | {"NI_Scale[0]_Scale_Type": "Magic"})),
        "scale type 'Magic'",
    ),
    "volts": (of(tdms, mic(unit="V", **STEP)), "'mic' has unit 'V'; expected samples over time in"),
    "a torque in Pa": (
        of(hdf5, mic(name="torque", fs=RATE)),
        "'torque' has unit 'Pa', expected 'N m'",
    ),
    "no number": (of(hdf5, mic(np.full(99, np.nan), fs=RATE)), "'pressure' is nan at sample 0"),
}


@pytest.mark.parametrize("name", UNCLEAR)
def test_values_that_are_not_clear_are_refused(name, tmp_path):
    assert_refused(UNCLEAR, name, tmp_path)


def test_a_sensitivity_beside_numbers_in_their_unit_is_noted(tmp_path):
    run = read_recording(of(hdf5, mic(fs=RATE, sensitivity=0.05))(tmp_path))
    np.testing.assert_array_equal(run.samples[0], X)
    assert "sensitivity 0.05, which is not applied" in run.notes[0]


def test_what_is_left_out_is_named_with_what_to_do(tmp_path, capfd):
    others = (mic(unit="degC", name="Oil", **STEP), mic(unit="V", name="Supply", **STEP))
    spectrum = mic(name="Spectrum", wf_increment=2.0, wf_xunit_string="Hz")
    path = of(tdms, mic(**STEP), *others, spectrum)(tmp_path)
    run = read_recording(path)
    read_recording(path)
    assert run.channel_names == ("pressure",)
    said = capfd.readouterr().err
    assert said.count("left out: 'Spectrum' has an axis in 'Hz'") == 1
    assert "'Oil' has unit 'degC'; 'Supply' has unit 'V'; name them in a sidecar" in said


def test_a_unit_in_the_sidecar_stands_for_that_of_the_file(tmp_path):
    path = of(hdf5, mic(unit="N mm", name="Arm", fs=RATE))(tmp_path)
    path.with_suffix(".json").write_text('{"channels": [{"name": "torque"}]}')
    np.testing.assert_allclose(read_recording(path)["torque"], 1e-3 * X)
    path.with_suffix(".json").write_text('{"channels": [{"name": "torque", "unit": "N m"}]}')
    run = read_recording(path)
    np.testing.assert_array_equal(run["torque"], X)
    assert "torque in N m stands for 'N mm' of channel 'Arm'" in run.notes[0]


def test_full_scale_is_worth_nothing_where_samples_are_in_a_unit(tmp_path):
    run = read_recording(of(tdms, mic(**STEP))(tmp_path), full_scale=20.0)
    np.testing.assert_array_equal(run.samples[0], X)
    assert "pressure is in Pa already" in run.notes[0]


# --- one recording whatever holds it ------------------------------------------------------------


@pytest.fixture(params=WRITERS)
def write(request, tmp_path):
    def writer(*waves):
        return WRITERS[request.param](tmp_path / f"run{request.param}", list(waves))

    return writer


def test_a_sidecar_names_channels_and_conditions(write):
    slow = Wave("oil", "degC", X[:400], 10.0)
    path = write(Wave("a", "Pa", X), Wave("b", "V", 3 * X), slow)
    assert read_recording(path).channel_names == ("pressure",)
    path.with_suffix(".json").write_text(
        '{"channels": [{"name": "pressure"}, {"name": "torque"}],'
        ' "conditions": {"speed_rad_s": 2.5}}'
    )
    run = read_recording(path)
    np.testing.assert_array_equal(run["torque"], 3 * X)
    assert run.condition.speed == 2.5


KINDS = {"torque": "N m", "acceleration": "m/s^2", "pressure": "Pa", "angle": "rad"}


@pytest.mark.parametrize("ending", ["wav", "tdms", "mf4", "h5", "uff"])
def test_the_same_samples_are_the_same_recording_in_any_container(ending, tmp_path):
    rows = dict(zip(KINDS, (8 + X, 30 * X, 0.1 * X, 10 * T), strict=True))
    path = tmp_path / f"x.{ending}"
    if ending == "wav":
        soundfile.write(path, np.array(list(rows.values())).T, 48_000, subtype="DOUBLE")
        names = [{"name": name, "unit": unit} for name, unit in KINDS.items()]
        (tmp_path / "x.json").write_text(json.dumps({"channels": names}))
    elif ending == "uff":
        uff(path, *((rows[k], unit) for k, unit in KINDS.items()), step=1 / RATE)
    else:
        WRITERS[f".{ending}"](path, [Wave(k, unit, rows[k], RATE) for k, unit in KINDS.items()])
    run = read_recording(path)
    assert names_channels(path)
    assert (set(run.channel_names), run.rate, run.calibrated) == (set(KINDS), RATE, True)
    np.testing.assert_allclose(run["torque"], 8 + X, atol=1e-9)
    np.testing.assert_allclose(run["angle"], 10 * T, atol=1e-9)
    assert run.notes == ()


# --- angles that wrap ---------------------------------------------------------------------------

TURN = 2 * np.pi
WRAPS = {"a turn": (lambda a: a % TURN, TURN), "backwards": (lambda a: -a % TURN, TURN)}


@pytest.mark.parametrize("speed", [5.0, 700.0])
@pytest.mark.parametrize(("wrap", "period"), WRAPS.values(), ids=WRAPS)
def test_an_angle_goes_on_where_it_wraps(wrap, period, speed, tmp_path):
    t = np.arange(int(4.3 * period / speed * 6000)) / 6000
    soundfile.write(tmp_path / "x.wav", wrap(speed * t + 1.0), 6000, subtype="DOUBLE")
    (tmp_path / "x.json").write_text('{"channels": [{"name": "angle"}]}')
    run = read_recording(tmp_path / "x.wav")
    assert abs(np.polyfit(t, run["angle"], 1)[0]) == pytest.approx(speed, rel=1e-3)


def test_an_angle_that_jumps_otherwise_is_noted(tmp_path):
    angle = 5.0 * T + 3.3 * (np.arange(N) >= 2000)
    run = read_recording(of(hdf5, mic(angle, "rad", fs=RATE))(tmp_path))
    np.testing.assert_array_equal(run["angle"], angle)
    assert "angle jumps by 3.3 rad at sample 2000, not by whole turns" in run.notes[0]


# --- libraries, and files that are no recordings ------------------------------------------------


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


DATA = os.environ.get("BUSHING_NOISE_REAL_DATA")


@pytest.mark.skipif(not DATA, reason="BUSHING_NOISE_REAL_DATA names no folder of real recordings")
def test_a_real_binary_universal_file_is_read_in_pascals():
    run = read_recording(Path(DATA) / "uff" / "Sample_UFF58b_bin.uff")
    assert (run.channel_names, run.rate, run.calibrated) == (("pressure",), 65536.0, True)
    assert run.samples.shape == (1, 79292)
