"""Files of response functions: what is written comes back, what cannot be used is refused."""

import numpy as np
import pytest

from models.errors import ParameterError
from models.transfer_functions.files import ENDINGS, read_transfer_function, write_transfer_function
from models.transfer_functions.transfer_function import TransferFunction

F = 0.78125 * np.arange(401)
H = F**2 * np.exp(1j * F / 30)


def read(path, input_unit="N m"):
    return read_transfer_function(path, input_unit=input_unit, output_unit="m/s^2")


def refusal(path, **options):
    """The one line that refuses a file."""
    with pytest.raises(ParameterError) as refused:
        read(path, **options)
    message = str(refused.value)
    assert message.startswith(str(path))
    assert "\n" not in message
    return message


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


def npz(path, **changed):
    content = {"frequency_hz": F, "response": H, "input_unit": "N m", "output_unit": "Pa"}
    content |= changed
    np.savez(path, **{key: value for key, value in content.items() if value is not None})


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"response": None}, "has no response"),
        ({"response": np.abs(H)}, "response has type float64; it must be complex"),
        ({"response": np.where(F == 0, np.nan, H)}, "response is (nan+0j) at line 1"),
        ({"frequency_hz": F[::-1]}, "frequency_hz falls from 312.5"),
        ({"coherence": 2 * np.ones(401)}, "coherence goes from 2 to 2"),
        ({"output_unit": np.array([1.0])}, "output_unit is '1.0'; it must be"),
    ],
)
def test_an_npz_that_cannot_be_used_is_refused_by_key(tmp_path, changed, message):
    path = tmp_path / "bad.npz"
    npz(path, **changed)
    assert message in refusal(path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "holds no rows of numbers"),
        ("frequency_hz,real\n1,2\n", "has no column imag; expected frequency_hz, real, imag"),
        ("frequency_hz,real,imag\n1,2,x\n", "imag is 'x' in line 2, expected a number"),
        ("frequency_hz,real,imag\n1,2,3\n1,2\n", "line 3 has 2 columns"),
    ],
)
def test_a_csv_that_cannot_be_used_is_refused_by_column(tmp_path, text, message):
    path = tmp_path / "bad.csv"
    path.write_text(text, encoding="utf-8")
    assert message in refusal(path)


W = 2j * np.pi * F
DATASET_164 = (
    "    -1\n   164\n{:10}{:20}         2\n{:25.16e}{:25.16e}{:25.16e}\n{:25.16e}\n    -1\n"
)


def universal(path, unit, data_type, *, per="N", axis="Hz", of_axis=18, units=None, direction=3):
    """Frequency response H as a program writes it, with the units of the file before it."""
    text = "" if units is None else DATASET_164.format(units[0], "", *units[1:], 1.0, 273.15)
    text += "    -1\n    58\nNONE\nNONE\n01-Jan-24 10:00:00\nNONE\nNONE\n"
    text += f"{4:5}{0:10}{0:5}{0:10} {'A':>10}{1:10}{3:4} {'B':>10}{1:10}{direction:4}\n"
    text += f"{6:10}{F.size:10}{1:10}{0:13.5e}{F[1]:13.5e}{0:13.5e}\n"
    for kind, label in ((of_axis, axis), (data_type, unit), (13, per), (0, "NONE")):
        text += f"{kind:10}{0:5}{0:5}{0:5} {'NONE':20} {label:20}\n"
    values = H.view(float)
    rows = [values[i : i + 4] for i in range(0, values.size, 4)]
    text += "".join("".join(f"{v:20.11e}" for v in row) + "\n" for row in rows) + "    -1\n"
    path.write_bytes(text.encode("latin-1"))
    return path


@pytest.mark.parametrize(
    ("unit", "data_type", "more", "factor"),
    [
        ("m/s\u00b2", 12, {}, 1.0),
        ("g", 12, {}, 9.80665),
        ("\u00b5m", 8, {}, 1e-6 * W**2),
        ("NONE", 8, {"per": "NONE"}, W**2),
        ("NONE", 12, {"per": "NONE", "units": (5, 1e3, 1e3)}, 1.0),
        ("mm/s^2", 12, {"units": (5, 1e3, 1.0)}, 1e-3),
        ("m/N", 0, {"per": "NONE"}, W**2),
    ],
)
def test_a_universal_response_is_converted_by_what_it_states(
    tmp_path, unit, data_type, more, factor
):
    path = universal(tmp_path / "a.uff", unit, data_type, **more)
    response = read(path, "N").response
    np.testing.assert_allclose(response, factor * H, rtol=1e-9, atol=1e-9 * np.abs(H).max())


@pytest.mark.parametrize(
    ("unit", "data_type", "more", "message"),
    [
        ("m/s^2", 12, {"units": (5, 1e3, 1e3)}, "by the units of the file (dataset 164) 1 is"),
        ("m/s^2", 15, {}, "'m/s^2', but has the data type of pressure"),
        ("V", 12, {}, "output_unit is 'V'; it must be 'm/s^2'"),
        ("m/s^2", 12, {"per": "N m"}, "input_unit is 'N m'; it must be 'N'"),
        ("NONE", 12, {"per": "NONE", "direction": 4}, "input_unit is 'N m'; it must be 'N'"),
        ("m/s^2", 12, {"axis": "s", "of_axis": 17}, "goes over s, expected frequency in Hz"),
    ],
)
def test_a_universal_response_that_is_another_one_is_refused(
    tmp_path, unit, data_type, more, message
):
    path = universal(tmp_path / "a.uff", unit, data_type, **more)
    assert message in refusal(path, input_unit="N")


def test_a_universal_response_that_states_no_unit_is_read_with_a_warning(tmp_path):
    path = universal(tmp_path / "a.uff", "NONE", 0)
    with pytest.warns(UserWarning, match=r"taken as m/s\^2 per N"):
        read(path, "N")


@pytest.mark.parametrize(
    ("header", "separator", "in_file"),
    [
        ("frequency_hz,real,imag,coherence", ",", (1.0, 1.0)),
        ("Frequency (kHz);Real (g/N m);Imag (g/N m);Coherence", ";", (1e-3, 1 / 9.80665)),
        ("frequency [Hz]\treal [(m/s^2)/kNm]\timag [(m/s^2)/kNm]\tcoherence", "\t", (1.0, 1e3)),
        ("frequency,real,imag,coherence\nHz,mm/s^2,mm/s^2,-", ",", (1.0, 1e3)),
    ],
)
def test_units_in_the_headings_of_a_csv_are_used(tmp_path, header, separator, in_file):
    path = tmp_path / "a.csv"
    columns = (in_file[0] * F, in_file[1] * H.real, in_file[1] * H.imag, np.ones(F.size))
    rows = (separator.join(f"{value:.12g}" for value in row) for row in zip(*columns, strict=True))
    text = header + "\n" + "\n".join(rows)
    path.write_text(text.replace(".", ",") if separator == ";" else text, encoding="utf-8")
    back = read(path)
    np.testing.assert_allclose(back.frequencies, F, rtol=1e-9)
    np.testing.assert_allclose(back.response, H, atol=1e-9 * np.abs(H).max())
