"""Measured responses in place of modelled ones."""

import numpy as np
import pytest

from models.errors import ParameterError
from models.radiation.impulse_responses import radiate
from models.radiation.rig_response import impulse_responses
from models.rig_file import load_material_rig, load_rig
from models.transfer_functions.files import write_transfer_function
from models.transfer_functions.transfer_function import TransferFunction
from tests.helpers.spectra import path_spectra

FIT = 0.279e-3
RATE = 48e3
F = np.arange(20.0, 20001.0, 2.0)

ENTRY = """material = "fluorocarbon"
[[measured_response]]
support_stiffness_Nm_rad = 2214
torque_to_acceleration = "a.npz"
"""


@pytest.fixture(scope="module")
def modelled():
    return impulse_responses(load_material_rig("fluorocarbon"), FIT, 2214.0, RATE, seconds=0.4)


def written(folder, text=ENTRY, **kinds):
    """A rig file beside the responses that it names."""
    for name, (values, unit, f) in kinds.items():
        write_transfer_function(
            folder / f"{name}.npz", TransferFunction(f, values, None, "N m", unit)
        )
    path = folder / "rig.toml"
    path.write_text(text, encoding="utf-8")
    return path


def rig_with(folder, modelled, gain=1.0, text=ENTRY, f=F):
    h = path_spectra(modelled, f)
    return load_rig(
        written(
            folder,
            text,
            a=(gain * h.torque_to_acceleration, "m/s^2", f),
            p=(gain * h.torque_to_pressure, "Pa", f),
        )
    )


def torque():
    t = np.arange(round(RATE)) / RATE
    return 8.0 + np.tanh(3 * np.sin(2 * np.pi * 163 * t)) * np.minimum(t / 0.01, 1.0)


def test_the_models_own_response_given_as_measured_gives_the_models_sound(tmp_path, modelled):
    text = ENTRY + 'torque_to_pressure = "p.npz"\n'
    rig = rig_with(tmp_path, modelled, text=text)
    measured = impulse_responses(rig, FIT, 2214.0, RATE, seconds=0.4)
    for found, true in zip(radiate(measured, torque()), radiate(modelled, torque()), strict=True):
        assert np.std(found - true) < 0.015 * np.std(true)


def test_another_support_stays_modelled(tmp_path, modelled):
    rig = rig_with(tmp_path, modelled, 2.0)
    other = impulse_responses(load_material_rig("fluorocarbon"), FIT, 3745.0, RATE, seconds=0.1)
    with pytest.warns(UserWarning, match="measured with the support 3745, only with 2214"):
        assert impulse_responses(rig, FIT, 3745.0, RATE, seconds=0.1) is other


def test_a_response_of_reversed_phase_is_refused(tmp_path, modelled):
    h = path_spectra(modelled, F).torque_to_acceleration.conj()
    rig = load_rig(written(tmp_path, a=(h, "m/s^2", F)))
    with pytest.raises(ParameterError, match=r"a\.npz: \d+ % of the response comes before its cau"):
        impulse_responses(rig, FIT, 2214.0, RATE, seconds=0.4)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("= 2214", '= "stiff"'), "support_stiffness_Nm_rad = 'stiff' must be"),
        (("support_stiffness_Nm_rad = 2214", ""), "support_stiffness_Nm_rad is missing"),
        (('torque_to_acceleration = "a.npz"', ""), "names no response"),
        (('"a.npz"', '"b.npz"'), "b.npz: there is no such file"),
        (("torque_to_acceleration", "torque_to_pressure"), "output_unit is 'm/s^2'; it must be"),
        (('"a.npz"', '"short.npz"'), "short.npz: stops at 3000 Hz; it must reach from 100 to 5000"),
        (('"a.npz"', '"late.npz"'), "late.npz: starts at 500 Hz; it must reach from 100 to 5000"),
        (("[[measured", "[[measured_response]]\nsupport_stiffness_Nm_rad = 2214.1\n"
          'torque_to_acceleration = "a.npz"\n[[measured'), "has an entry already"),
    ],
)  # fmt: skip
def test_an_entry_that_cannot_be_used_is_refused_by_field(tmp_path, change, message):
    ones = F + 0j
    path = written(
        tmp_path,
        ENTRY.replace(*change, 1),
        a=(ones, "m/s^2", F),
        short=(ones[F <= 3000], "m/s^2", F[F <= 3000]),
        late=(ones[F >= 500], "m/s^2", F[F >= 500]),
    )
    with pytest.raises(ParameterError) as refused:
        load_rig(path)
    assert message in str(refused.value)
    assert f"rig file {path}, measured_response" in str(refused.value)
    assert "\n" not in str(refused.value)
