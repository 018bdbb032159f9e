"""What files of loggers state about axis and value is used, or refused with the reason."""

from __future__ import annotations

import json

import numpy as np
import pytest
import soundfile
from asammdf import Signal

from models.errors import RecordingError
from noise.recordings import read_recording
from noise.recordings.files import names_channels
from tests.helpers.logger_files import hdf5, mdf, tdms, uff

N, RATE = 4800, 48e3
T = np.arange(N) / RATE
X = np.sqrt(2) * np.sin(2 * np.pi * 1000 * T)  # 1 Pa rms
LATE = 96  # samples: 2 ms


def clock(times, unit="s", **attributes):
    return ("Time", times, {"unit_string": unit, "unit": unit, **attributes})


def mic(x=X, unit="Pa", **properties):
    return ("mic", x, {"unit_string": unit, "unit": unit, **properties})


def signal(x=X, t=T, unit="Pa", name="mic"):
    return Signal(x, t, unit=unit, name=name)


STEP = {"wf_increment": 1 / RATE}
DAY = np.datetime64("2024-01-01T10:00:00", "us")


# --- the axis: 48 kHz, or refused for a reason that says what stands there ---------------------

AXES = {
    "tdms step": lambda p: tdms(p / "x.tdms", mic(**STEP)),
    "tdms step, Time in s": lambda p: tdms(
        p / "x.tdms", mic(**STEP, wf_xname="Time", wf_xunit_string="s")
    ),
    "tdms step in ms": lambda p: tdms(
        p / "x.tdms", mic(wf_increment=1e3 / RATE, wf_xunit_string="ms")
    ),
    "tdms clock in ms": lambda p: tdms(p / "x.tdms", clock(1e3 * T, "ms"), mic()),
    "tdms clock in us, by its name": lambda p: tdms(
        p / "x.tdms", ("Time (us)", 1e6 * T, {}), mic()
    ),
    "tdms clock in min": lambda p: tdms(p / "x.tdms", clock(T / 60, "min"), mic()),
    "tdms clock beside a step that nobody set": lambda p: tdms(
        p / "x.tdms", clock(T), mic(wf_increment=1.0)
    ),
    "mdf in ms": lambda p: mdf(p / "x.mf4", [signal(t=1e3 * T)], unit="ms"),
    "mdf without a unit": lambda p: mdf(p / "x.mf4", [signal()], unit=""),
    "mdf that begins late": lambda p: mdf(p / "x.mf4", [signal(t=T + 17.25)]),
    "hdf5 rate": lambda p: hdf5(p / "x.h5", mic(fs=RATE)),
    "hdf5 step in ms": lambda p: hdf5(p / "x.h5", mic(dt=1e3 / RATE, x_unit="ms")),
    "hdf5 time in ms": lambda p: hdf5(p / "x.h5", mic(), ("time", 1e3 * T, {"units": "ms"})),
    "hdf5 time_ms": lambda p: hdf5(p / "x.h5", mic(), ("time_ms", 1e3 * T, {})),
    "hdf5 time packed": lambda p: hdf5(
        p / "x.h5", mic(), ("time", np.arange(N), {"units": "s", "scale_factor": 1 / RATE})
    ),
    "hdf5 seconds since": lambda p: hdf5(
        p / "x.h5", mic(), ("time", T, {"units": "seconds since 2024-01-01 10:00:00"})
    ),
    "hdf5 rate and time agree": lambda p: hdf5(
        p / "x.h5", mic(fs=RATE), ("time", 1e3 * T, {"unit": "ms"})
    ),
    "uff in s": lambda p: uff(p / "x.uff", (X, "Pa"), step=1 / RATE),
}


@pytest.mark.parametrize("make", AXES.values(), ids=AXES)
def test_the_sampling_rate_is_what_the_axis_states(make, tmp_path):
    run = read_recording(make(tmp_path))
    assert (run.rate, run.channel_names) == (RATE, ("pressure",))
    np.testing.assert_allclose(run.samples[0], X, atol=1e-9)


def test_a_clock_may_tell_the_time_of_day(tmp_path):
    stamps = DAY + 125 * np.arange(N) * np.timedelta64(1, "us")
    assert read_recording(tdms(tmp_path / "x.tdms", ("Zeit", stamps, {}), mic())).rate == 8000.0


NO_TIME = {
    "a spectrum in TDMS": (
        lambda p: tdms(p / "x.tdms", mic(wf_increment=1.0, wf_xunit_string="Hz")),
        "stands over in 'Hz', expected time",
    ),
    "a spectrum in TDMS, by its name": (
        lambda p: tdms(p / "x.tdms", mic(wf_increment=2.0, wf_xname="Frequency")),
        "stands over 'Frequency', expected time",
    ),
    "a step that nobody set": (
        lambda p: tdms(p / "x.tdms", mic(wf_increment=1.0)),
        "states no sampling rate",
    ),
    "a clock that contradicts the step": (
        lambda p: tdms(p / "x.tdms", clock(2 * T), mic(**STEP)),
        "states two sampling rates, 48000 and 24000 Hz",
    ),
    "the angle of a shaft": (
        lambda p: mdf(p / "x.mf4", [signal()], unit="deg", sync=2),
        "stands over angle in 'deg', expected time",
    ),
    "an angle without a unit": (
        lambda p: mdf(p / "x.mf4", [signal()], unit="", sync=2),
        "stands over 'angle', expected time",
    ),
    "a distance": (
        lambda p: mdf(p / "x.mf4", [signal()], unit="m", sync=3),
        "stands over distance in 'm', expected time",
    ),
    "times that are not even": (
        lambda p: mdf(p / "x.mf4", [signal(t=T + 1e-3 * (T > 0.05))]),
        "time that does not rise evenly",
    ),
    "an axis in Hz in HDF5": (
        lambda p: hdf5(p / "x.h5", mic(dt=0.5, x_unit="Hz")),
        "stands over in 'Hz', expected time",
    ),
    "a rate that the time beside it contradicts": (
        lambda p: hdf5(p / "x.h5", mic(), ("time", 2 * T, {}), root={"fs": RATE}),
        "states two sampling rates",
    ),
    "time of another length": (
        lambda p: hdf5(p / "x.h5", mic(), ("time", T[:-9], {})),
        "states no sampling rate",
    ),
}


@pytest.mark.parametrize(("make", "reason"), NO_TIME.values(), ids=NO_TIME)
def test_what_does_not_stand_over_time_is_refused(make, reason, tmp_path):
    with pytest.raises(RecordingError) as refused:
        read_recording(make(tmp_path))
    assert reason in str(refused.value)
    assert "\n" not in str(refused.value)


# --- where channels begin: the same sample at the same time -------------------------------------

A, B = X[: N - LATE], X[LATE:]  # of one signal, the second channel begins 2 ms late

STARTS = {
    "tdms offset": lambda p: tdms(
        p / "x.tdms",
        ("a", A, {"unit_string": "Pa", **STEP, "wf_start_offset": 0.0}),
        ("b", B, {"unit_string": "Pa", **STEP, "wf_start_offset": LATE / RATE}),
    ),
    "tdms time of day": lambda p: tdms(
        p / "x.tdms",
        ("a", A, {"unit_string": "Pa", **STEP, "wf_start_time": DAY}),
        ("b", B, {"unit_string": "Pa", **STEP, "wf_start_time": DAY + np.timedelta64(2, "ms")}),
    ),
    "mdf masters": lambda p: mdf(
        p / "x.mf4",
        [signal(A, T[: N - LATE], name="a")],
        [signal(B, T[LATE:], name="b")],
    ),
    "mdf masters in ms": lambda p: mdf(
        p / "x.mf4",
        [signal(A, 1e3 * T[: N - LATE], name="a")],
        [signal(B, 1e3 * T[LATE:], name="b")],
        unit="ms",
    ),
    "hdf5 times": lambda p: hdf5(
        p / "x.h5",
        *(("one/mic", A, {"unit": "Pa"}), ("one/time", T[: N - LATE], {})),
        *(("two/mic", B, {"unit": "Pa"}), ("two/time", 1e3 * T[LATE:], {"unit": "ms"})),
    ),
    "hdf5 rate and times": lambda p: hdf5(
        p / "x.h5",
        *(("one/mic", A, {"unit": "Pa"}), ("one/time", T[: N - LATE], {})),
        *(("two/mic", B, {"unit": "Pa"}), ("two/time", T[LATE:], {})),
        root={"fs": RATE},
    ),
    "hdf5 t0": lambda p: hdf5(
        p / "x.h5",
        ("a", A, {"unit": "Pa", "fs": RATE, "t0": 0.0}),
        ("b", B, {"unit": "Pa", "fs": RATE, "t0": LATE / RATE}),
    ),
    "uff abscissa": lambda p: uff(
        p / "x.uff", (A, "Pa", 15, 0.0, len(A)), (B, "Pa", 15, LATE / RATE, len(B)), step=1 / RATE
    ),
}


@pytest.mark.parametrize("make", STARTS.values(), ids=STARTS)
def test_channels_are_aligned_by_their_start(make, tmp_path):
    run = read_recording(make(tmp_path))
    assert run.samples.shape == (2, N - 2 * LATE)
    np.testing.assert_allclose(run.samples[0], X[LATE : N - LATE], atol=1e-9)
    np.testing.assert_allclose(run.samples[1], run.samples[0], atol=1e-9)
    assert any("begin up to 2 ms apart" in note for note in run.notes)


def begins(path, late, n=N):
    return tdms(
        path / "x.tdms",
        ("a", X, {"unit_string": "Pa", **STEP, "wf_start_offset": 0.0}),
        ("b", X[:n], {"unit_string": "Pa", **STEP, "wf_start_offset": late}),
    )


@pytest.mark.parametrize(
    ("late", "n", "reason"),
    [
        (10.4 / RATE, N, "channel 'a' is sampled 0.40 of a step beside 'b'"),
        (0.0, N // 3, "have 1600 samples in common ('a' 4800 from 0 s, 'b' 1600 from 0 s)"),
        (1.0, N, "have 0 samples in common ('a' 4800 from 0 s, 'b' 4800 from 1 s)"),
    ],
)
def test_channels_that_cannot_be_aligned_are_refused(late, n, reason, tmp_path):
    with pytest.raises(RecordingError) as refused:
        read_recording(begins(tmp_path, late, n))
    assert reason in str(refused.value)


def test_a_channel_that_does_not_state_when_it_begins_beside_others_that_do_is_refused(tmp_path):
    path = tdms(
        tmp_path / "x.tdms",
        *(
            ("abc"[i], X, {"unit_string": "Pa", **STEP, "wf_start_offset": late})
            for i, late in enumerate((0.0, 0.1))
        ),
        ("c", X, {"unit_string": "Pa", **STEP}),
    )
    with pytest.raises(RecordingError, match="does not state when channel 'c' begins"):
        read_recording(path)


def test_a_few_samples_more_are_cut_with_a_note(tmp_path):
    run = read_recording(begins(tmp_path, 0.0, N - 3))
    assert run.samples.shape == (2, N - 3)
    assert "cut to the 4797 samples in common" in run.notes[0]


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

VALUES = {
    "hdf5 packed": lambda p: hdf5(p / "x.h5", mic(COUNTS, fs=RATE, **PACKED)),
    "hdf5 packed with an offset": lambda p: hdf5(
        p / "x.h5", mic(COUNTS + 5, fs=RATE, scale_factor=1e-4, add_offset=-5e-4)
    ),
    "hdf5 packed in mPa": lambda p: hdf5(
        p / "x.h5", mic(COUNTS, unit="mPa", fs=RATE, scale_factor=0.1)
    ),
    "hdf5 with a gain of 1": lambda p: hdf5(p / "x.h5", mic(fs=RATE, gain=1.0)),
    "tdms packed": lambda p: tdms(p / "x.tdms", mic(COUNTS, **STEP, **PACKED)),
    "tdms scale": lambda p: tdms(p / "x.tdms", mic(COUNTS, **STEP, **LINEAR)),
    "mdf conversion": lambda p: mdf(
        p / "x.mf4",
        [Signal(COUNTS, T, unit="Pa", name="mic", conversion={"a": 1e-4, "b": 0.0})],
    ),
    **{
        f"tdms in {unit}": lambda p, unit=unit, f=f: tdms(
            p / "x.tdms", mic(X / f, unit=unit, **STEP)
        )
        for unit, f in (("Pascal", 1), ("[Pa]", 1), ("PA", 1), ("N/m^2", 1), ("µPa", 1e-6))
    },
    "hdf5 unit behind the name": lambda p: hdf5(p / "x.h5", ("Mic [kPa]", X / 1e3, {"fs": RATE})),
}


@pytest.mark.parametrize("make", VALUES.values(), ids=VALUES)
def test_values_are_brought_to_si_by_all_that_is_stated(make, tmp_path):
    run = read_recording(make(tmp_path))
    assert run.channel_names == ("pressure",)
    np.testing.assert_allclose(run.samples[0], X, atol=1e-4)


UNCLEAR = {
    "a gain of whole numbers": (
        lambda p: hdf5(p / "x.h5", mic(COUNTS, fs=RATE, gain=20.0)),
        "has gain 20, and does not state how to apply it",
    ),
    "a sensitivity of whole numbers": (
        lambda p: tdms(p / "x.tdms", mic(COUNTS, **STEP, Sensitivity=0.05)),
        "has sensitivity 0.05, and does not state how to apply it",
    ),
    "an infinite factor": (
        lambda p: hdf5(p / "x.h5", mic(COUNTS, fs=RATE, scale_factor=np.inf)),
        "has factor inf",
    ),
    "a conversion that is partly text": (
        lambda p: mdf(
            p / "x.mf4",
            [
                Signal(
                    COUNTS, T, unit="Pa", name="mic",
                    conversion={"lower_0": 9, "upper_0": 9, "text_0": b"error", "default": b""},
                )
            ],
        ),
        "has a conversion that makes texts of its values",
    ),
    "volts": (lambda p: tdms(p / "x.tdms", mic(unit="V", **STEP)), "has unit 'V'"),
    "no unit": (lambda p: hdf5(p / "x.h5", mic(unit="", fs=RATE)), "states no unit"),
    "a torque in Pa": (
        lambda p: hdf5(p / "x.h5", ("torque", X, {"unit": "Pa", "fs": RATE})),
        "has unit 'Pa', expected 'N m'",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("make", "reason"), UNCLEAR.values(), ids=UNCLEAR)
def test_values_that_are_not_clear_are_refused(make, reason, tmp_path):
    with pytest.raises(RecordingError) as refused:
        read_recording(make(tmp_path))
    assert reason in str(refused.value)


def test_a_sensitivity_beside_numbers_in_their_unit_is_noted(tmp_path):
    run = read_recording(hdf5(tmp_path / "x.h5", mic(fs=RATE, sensitivity=0.05)))
    np.testing.assert_array_equal(run.samples[0], X)
    assert "sensitivity 0.05, which is not applied" in run.notes[0]


def test_what_is_left_out_is_named_with_what_to_do(tmp_path, capfd):
    path = tdms(
        tmp_path / "x.tdms",
        mic(**STEP),
        ("Oil", X, {"unit_string": "degC", **STEP}),
        ("Supply", X, {"unit_string": "V", **STEP}),
        ("Spectrum", X, {"unit_string": "Pa", "wf_increment": 2.0, "wf_xunit_string": "Hz"}),
    )
    run = read_recording(path)
    read_recording(path)
    assert run.channel_names == ("pressure",)
    said = capfd.readouterr().err
    assert said.count("left out: 'Spectrum' stands over in 'Hz'") == 1
    assert "'Oil' has unit 'degC'; 'Supply' has unit 'V'; a sidecar that names them" in said


def test_a_unit_in_the_sidecar_stands_for_that_of_the_file(tmp_path):
    path = hdf5(tmp_path / "x.h5", ("Arm", X, {"unit": "N mm", "fs": RATE}))
    path.with_suffix(".json").write_text('{"channels": [{"name": "torque"}]}')
    np.testing.assert_allclose(read_recording(path)["torque"], 1e-3 * X)
    path.with_suffix(".json").write_text('{"channels": [{"name": "torque", "unit": "N m"}]}')
    run = read_recording(path)
    np.testing.assert_array_equal(run["torque"], X)
    assert "torque in N m stands for 'N mm' of channel 'Arm'" in run.notes[0]


def test_full_scale_is_worth_nothing_where_samples_are_in_a_unit(tmp_path):
    path = tdms(tmp_path / "x.tdms", mic(**STEP))
    run = read_recording(path, full_scale=20.0)
    np.testing.assert_array_equal(run.samples[0], X)
    assert "pressure is in Pa already" in run.notes[0]
    soundfile.write(tmp_path / "x.wav", X / 2, 48_000, subtype="FLOAT")
    assert np.ptp(read_recording(tmp_path / "x.wav", full_scale=20.0).samples) > 25


# --- an angle that wraps ------------------------------------------------------------------------

TURN = 2 * np.pi
ANGLE = 40.0 * T + 3.0  # 40 rad/s for 0.1 s, and more where more turns are wanted

WRAPS = {
    "a turn": (lambda a: a % TURN, TURN),
    "a turn from -pi": (lambda a: (a + np.pi) % TURN - np.pi, TURN),
    "ten turns": (lambda a: a % (10 * TURN), 10 * TURN),
    "32-bit counts": (lambda a: a % (2**16 * TURN / 1000), 2**16 * TURN / 1000),
    "backwards": (lambda a: -a % TURN, TURN),
}


@pytest.mark.parametrize("speed", [5.0, 700.0])
@pytest.mark.parametrize(("wrap", "period"), WRAPS.values(), ids=WRAPS)
def test_an_angle_goes_on_where_it_wraps(wrap, period, speed, tmp_path):
    turns = 4.3 * period
    n = int(turns / speed * 6000)
    t = np.arange(n) / 6000
    angle = wrap(speed * t + 1.0)
    soundfile.write(tmp_path / "x.wav", angle, 6000, subtype="DOUBLE")
    (tmp_path / "x.json").write_text('{"channels": [{"name": "angle"}]}')
    run = read_recording(tmp_path / "x.wav")
    assert abs(np.polyfit(t, run["angle"], 1)[0]) == pytest.approx(speed, rel=1e-3)


def test_an_oscillation_over_the_end_of_a_turn_goes_on_as_well(tmp_path):
    angle = 0.3 * np.sin(2 * np.pi * 20 * T)
    run = read_recording(
        hdf5(tmp_path / "x.h5", ("Shaft", np.rad2deg(angle % TURN), {"unit": "deg", "fs": RATE}))
    )
    np.testing.assert_allclose(run["angle"] - run["angle"][0], angle - angle[0], atol=1e-9)


def test_an_angle_that_jumps_otherwise_is_said(tmp_path):
    angle = 5.0 * T
    angle[2000:] += 3.3
    run = read_recording(hdf5(tmp_path / "x.h5", ("a", angle, {"unit": "rad", "fs": RATE})))
    np.testing.assert_array_equal(run["angle"], angle)
    assert "angle jumps by 3.3 rad at sample 2000, which are no whole turns" in run.notes[0]


# --- one recording whatever holds it ------------------------------------------------------------

KINDS = {"torque": "N m", "acceleration": "m/s^2", "pressure": "Pa", "angle": "rad"}


def one_of_each(path, ending):
    rows = dict(zip(KINDS, (8 + X, 30 * X, 0.1 * X, 10 * T), strict=True))
    if ending == ".wav":
        soundfile.write(path / "x.wav", np.array(list(rows.values())).T, 48_000, subtype="DOUBLE")
        names = [{"name": name, "unit": unit} for name, unit in KINDS.items()]
        (path / "x.json").write_text(json.dumps({"channels": names}))
    elif ending == ".uff":
        uff(path / "x.uff", *((rows[k], unit) for k, unit in KINDS.items()), step=1 / RATE)
    elif ending == ".mf4":
        mdf(path / "x.mf4", [signal(rows[k], T, unit, k) for k, unit in KINDS.items()])
    else:
        write = {".tdms": tdms, ".h5": hdf5}[ending]
        stated = {"unit_string": "", "wf_increment": 1 / RATE} if write is tdms else {"fs": RATE}
        channels = ((k, rows[k], stated | {"unit": u, "unit_string": u}) for k, u in KINDS.items())
        write(path / f"x{ending}", *channels)
    return path / f"x{ending}"


@pytest.mark.parametrize("ending", [".wav", ".tdms", ".mf4", ".h5", ".uff"])
def test_the_same_samples_are_the_same_recording_in_any_container(ending, tmp_path):
    path = one_of_each(tmp_path, ending)
    run = read_recording(path)
    assert names_channels(path)
    assert (set(run.channel_names), run.rate, run.calibrated) == (set(KINDS), RATE, True)
    np.testing.assert_allclose(run["torque"], 8 + X, atol=1e-9)
    np.testing.assert_allclose(run["angle"], 10 * T, atol=1e-9)
    assert run.notes == ()
