"""Files of response functions: what is written comes back, what cannot be used is refused."""

import numpy as np
import pytest

from models.errors import ParameterError
from models.transfer_functions.coherence import check_band, trusted_band
from models.transfer_functions.files import ENDINGS, read_transfer_function, write_transfer_function
from models.transfer_functions.transfer_function import TransferFunction
from models.transfer_functions.uff import (
    TIME_RESPONSE,
    UffFunction,
    read_uff_functions,
    write_uff_functions,
)

F = 0.78125 * np.arange(401)
H = F**2 * np.exp(1j * F / 30)


def read(path):
    return read_transfer_function(path, input_unit="N m", output_unit="m/s^2")


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("coherence", [None, np.cos(F / 50) ** 2])
def test_a_response_is_read_as_it_was_written(tmp_path, ending, coherence):
    path = tmp_path / f"beam{ending}"
    write_transfer_function(path, TransferFunction(F, H, coherence, "N m", "m/s^2"))
    back = read(path)
    np.testing.assert_allclose(back.frequencies, F, rtol=1e-12)
    np.testing.assert_allclose(back.response, H, atol=1e-10 * np.abs(H).max())
    assert (back.input_unit, back.output_unit) == ("N m", "m/s^2")
    if coherence is None:
        assert back.coherence is None
    else:
        np.testing.assert_allclose(back.coherence, coherence, atol=1e-9)


@pytest.mark.parametrize("rate", [25600.0, 44100.0, 48000.0, 51200.0, 65536.0, 96000.0])
def test_a_universal_file_keeps_the_sampling_rate(tmp_path, rate):
    path = tmp_path / "run.uff"
    t = np.arange(5000) / rate
    write_uff_functions(path, [UffFunction(TIME_RESPONSE, t, np.sin(t), "Pa")])
    (back,) = read_uff_functions(path)
    assert 1 / back.x[1] == pytest.approx(rate, rel=1e-12)


def test_of_several_functions_the_one_in_the_right_unit_is_read(tmp_path):
    path = tmp_path / "both.unv"
    write_uff_functions(
        path, [UffFunction(4, F, k * H, unit, "N m") for k, unit in ((1, "m/s^2"), (2, "Pa"))]
    )
    sound = read_transfer_function(path, input_unit="N m", output_unit="Pa")
    np.testing.assert_allclose(sound.response[-1], 2 * H[-1])
    with pytest.raises(ParameterError, match="holds 0 frequency response functions in m/s"):
        read_transfer_function(path, input_unit="N m", output_unit="m/s")


def npz(path, **changed):
    content = {"frequency_hz": F, "response": H, "input_unit": "N m", "output_unit": "Pa"}
    content |= changed
    np.savez(path, **{key: value for key, value in content.items() if value is not None})


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"response": None}, "has no response"),
        ({"input_unit": None}, "has no input_unit"),
        ({"response": np.abs(H)}, "response has type float64; it must be complex"),
        ({"response": H[:-1]}, "response has shape (400,)"),
        ({"response": np.where(F == 0, np.nan, H)}, "response is (nan+0j) at line 1"),
        ({"response": 0 * H}, "zero throughout"),
        ({"frequency_hz": F[::-1]}, "frequency_hz falls from 312.5"),
        ({"frequency_hz": np.ones(401)}, "frequency_hz stays at 1 Hz at line 2; it must rise"),
        ({"frequency_hz": F - 1}, "starts at -1 Hz"),
        ({"frequency_hz": F[:3], "response": H[:3]}, "at least 8"),
        ({"coherence": 2 * np.ones(401)}, "coherence goes from 2 to 2"),
        ({"coherence": np.ones(4)}, "coherence has shape (4,)"),
        ({"output_unit": np.array([1.0])}, "output_unit is array([1.]); it must be a text"),
        ({"frequency_hz": np.array(["a"] * 401)}, "it must be numbers"),
    ],
)
def test_an_npz_that_cannot_be_used_is_refused_by_key(tmp_path, changed, message):
    path = tmp_path / "bad.npz"
    npz(path, **changed)
    with pytest.raises(ParameterError) as refused:
        read(path)
    assert message in str(refused.value)
    assert str(refused.value).startswith(str(path))
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "has no column frequency_hz"),
        ("frequency_hz,real\n1,2\n", "has no column imag"),
        ("frequency_hz,real,imag\n1,2,x\n", "imag is 'x' at line 1; it must be a number"),
        ("frequency_hz,real,imag\n1,2\n", "imag is '' at line 1"),
        ("frequency_hz,real,imag\n1,2,3\n", "at least 8"),
    ],
)
def test_a_csv_that_cannot_be_used_is_refused_by_column(tmp_path, text, message):
    path = tmp_path / "bad.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ParameterError) as refused:
        read(path)
    assert message in str(refused.value)
    assert str(refused.value).startswith(str(path))


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize(
    "content", [b"", b"\x00\xff garbage \n 1,2", b"    -1\n    58\n  bad\n    -1\n"]
)
def test_a_damaged_file_is_one_line(tmp_path, ending, content):
    path = tmp_path / f"bad{ending}"
    path.write_bytes(content)
    with pytest.raises(ParameterError) as refused:
        read(path)
    assert str(path) in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_missing_file_is_one_line(tmp_path, ending):
    with pytest.raises(ParameterError, match="nowhere"):
        read(tmp_path / f"nowhere{ending}")


def test_an_unknown_ending_names_the_known_ones(tmp_path):
    with pytest.raises(ParameterError, match=r"\.npz, \.csv, \.uff or \.unv"):
        read(tmp_path / "beam.mat")


def test_a_missing_library_names_the_command_that_installs_it(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pyuff", None)
    with pytest.raises(ParameterError, match=r'pip install "bushing-noise\[uff\]"'):
        read(tmp_path / "beam.uff")


def test_single_lines_of_low_coherence_leave_the_band_whole():
    coherence = np.where(np.arange(401) % 9 == 0, 0.0, 0.9)
    assert trusted_band(TransferFunction(F, H, coherence, "N m", "Pa")) == (F[1], F[-1])


def test_what_does_not_cohere_does_not_count_towards_the_band():
    frf = TransferFunction(F, H, np.where(F > 200, 0.1, 0.9), "N m", "Pa", "beam.npz")
    with pytest.raises(ParameterError, match=r"beam.npz: stops at 20\d.* with a coherence of 0.5"):
        check_band(frf, 10.0, 300.0)
    with pytest.raises(ParameterError, match=r"starts at 0.78125 Hz; it must reach from 0.5"):
        check_band(TransferFunction(F, H, None, "N m", "Pa"), 0.5, 300.0)
