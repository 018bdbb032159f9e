"""From the torque to acceleration and sound: as measured where the rig file says so."""

from __future__ import annotations

import numpy as np
import pytest

from models.condition import FIXED
from models.rig_file import load_rig
from models.transfer_functions.transfer_function import TransferFunction
from noise.diagnosis.simulated.transfer_functions import predict, torque_transfer_functions
from tests.helpers.small_rigs import RIG, RIG_FILE

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")  # of what was not measured

FREQUENCY = np.arange(2.0, 12e3, 2.0)


def _table(response):
    return TransferFunction(
        FREQUENCY, np.broadcast_to(np.asarray(response, np.complex128), FREQUENCY.shape)
    )


@pytest.fixture
def rig_with(tmp_path):
    """A rig file with measured responses for one support."""

    def made(support, **responses):
        lines = [RIG_FILE, "[[measured_response]]", f"support_stiffness_Nm_rad = {support}"]
        for name, response in responses.items():
            unit = {"torque_to_acceleration": "m/s^2", "torque_to_pressure": "Pa"}[name]
            path = tmp_path / f"{name}.npz"
            np.savez(
                path, frequency_hz=FREQUENCY, response=np.full(FREQUENCY.size, response + 0j),
                input_unit="N m", output_unit=unit,
            )  # fmt: skip
            lines.append(f'{name} = "{path.name}"')
        (tmp_path / "rig.toml").write_text("\n".join(lines))
        return load_rig(tmp_path / "rig.toml")

    return made


def test_a_measured_response_is_taken_line_by_line(rig_with):
    rig = rig_with(2214, torque_to_acceleration=3.0 - 4.0j, torque_to_pressure=0.5j)
    found = torque_transfer_functions(rig, 0.279e-3, 2214.0)
    assert found["acceleration"].at(np.array([777.0, 3e3])) == pytest.approx([3 - 4j] * 2, rel=1e-3)
    assert found["pressure"].at(np.array([100.0])) == pytest.approx([0.5j], abs=0.01)


def test_what_was_not_measured_is_modelled(rig_with):
    found = torque_transfer_functions(rig_with(2214, torque_to_acceleration=3.0), 0.279e-3, 2214.0)
    assert found["acceleration"].at(np.array([500.0])) == pytest.approx([3.0])
    modelled = torque_transfer_functions(RIG, 0.279e-3, 2214.0)["pressure"]
    at = np.arange(100.0, 5e3, 100.0)  # inertias of the two rigs differ in the fourth digit
    assert found["pressure"].at(at) == pytest.approx(modelled.at(at), rel=0.01)


def test_a_measured_response_is_of_its_own_support_alone(rig_with):
    rig = rig_with(2214, torque_to_acceleration=3.0, torque_to_pressure=1.0)
    for support in (3745.0, FIXED):
        other = torque_transfer_functions(rig, 0.279e-3, support)["acceleration"].response
        assert not np.allclose(other, 3.0)
    fixed = rig_with('"fixed"', torque_to_acceleration=7.0, torque_to_pressure=1.0)
    bolted = torque_transfer_functions(fixed, 0.279e-3, FIXED)["acceleration"].at(
        np.array([500.0, 3e3])
    )
    assert bolted == pytest.approx([7.0, 7.0], rel=1e-3)


def test_a_transfer_function_turns_the_phase_as_the_response_says():
    rate, n = 20e3, 8000
    time = np.arange(n) / rate
    torque = np.sin(2 * np.pi * 400.0 * time)
    heard = predict(torque, rate, _table(2.0j))  # i: a quarter of a period ahead
    expected = 2.0 * np.cos(2 * np.pi * 400.0 * time)
    assert np.abs(heard - expected)[2000:-2000].max() < 0.03


def test_a_delay_in_the_response_delays_the_sound():
    rate = 20e3
    torque = np.zeros(6000)
    torque[3000:3003] = 1.0
    delayed = TransferFunction(FREQUENCY, np.exp(-2j * np.pi * FREQUENCY * 2e-3))
    heard = predict(torque, rate, delayed)
    assert abs(int(np.argmax(heard)) - (3001 + 40)) <= 1
    assert np.abs(heard[:3030]).max() < 0.1 * heard.max()


def test_the_simulator_sends_its_torque_through_the_same_transfer_functions():
    from sim.acquisition import Acquisition
    from sim.run import simulate

    quiet = Acquisition(noise={})
    recording = simulate(
        RIG, 1.0, support_stiffness=3745.0, seconds=0.4, acquisition=quiet
    ).recording
    found = torque_transfer_functions(RIG, 0.279e-3, 3745.0)
    inside = slice(round(0.1 * recording.rate), -round(0.02 * recording.rate))
    for kind in ("acceleration", "pressure"):
        predicted = predict(recording["torque"], recording.rate, found[kind])
        left = (predicted - recording[kind])[inside]
        assert np.std(left) < 0.1 * np.std(recording[kind][inside]), kind
