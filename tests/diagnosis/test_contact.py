"""What a contact did, and what it did otherwise, is in the numbers that are named after it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from models.condition import FIXED
from noise.diagnosis.evidence.contact_summary import contact_summary
from noise.diagnosis.evidence.reconstruction import reconstruct
from noise.diagnosis.evidence.summary import case_table, summary
from noise.diagnosis.simulated.transfer_functions import torque_transfer_functions
from sim.bushing import lumped_bushing
from tests.helpers.small_rigs import RATE, RIG, at, run

FIT, SECONDS = RIG.fits[0], 0.6


def _numbers(*effects, speed=1.5, seed=0, rig=RIG):
    """Summarise a run with the clamp bolted down, which has one cycle after the other."""
    recording = run(at(speed, FIXED), *effects, seed=seed, seconds=SECONDS, rig=rig)
    torque = recording["torque"]
    bushing = lumped_bushing(RIG, 0.279e-3, FIXED)
    found = reconstruct(torque, np.full(torque.size, speed), RATE, bushing)
    return contact_summary(found, FIT, speed)


@pytest.fixture(scope="module")
def plain():
    return _numbers()


def test_a_plain_contact_has_the_rig_files_torques(plain):
    assert plain["kinetic"] == pytest.approx(1.0, abs=0.03)
    assert plain["peak"] == pytest.approx(1.0, abs=0.04)
    assert plain["peak_spread"] < 0.02
    assert plain["kinetic_drift"] == pytest.approx(0.0, abs=0.02)
    for i in range(3, 6):
        assert plain[f"law_down_{i}"] == pytest.approx(1.0, abs=0.05)
    assert plain["stiffness_all"] == pytest.approx(1.0, abs=0.1)


def test_slips_come_as_often_as_the_cycle_says(plain):
    # the torque's fall is wound up again by the shaft
    fall = 2.0 * (FIT.critical_torque - FIT.kinetic_torque)
    winding = fall / (FIT.elastomer_stiffness * 1.5)
    interval = math.exp(plain["interval"])
    assert 0.8 * winding < interval < 1.4 * winding
    assert math.exp(plain["slip_rate"]) == pytest.approx(1.0 / interval, rel=0.15)


def test_a_contact_that_gives_before_it_breaks_creeps_when_the_torque_is_high(plain):
    # the surface of a true stick stays where it is, at any torque
    creeping = _numbers(("partial_slip", {"share": 0.8}))
    assert abs(plain["creep_up_4"]) < 0.15
    assert creeping["creep_up_4"] > plain["creep_up_4"] + 0.1
    assert creeping["creep_up_5"] > creeping["creep_up_3"] + 0.2
    assert creeping["stiffness_late"] < creeping["stiffness_early"] - 0.2
    assert creeping["kinetic"] == pytest.approx(plain["kinetic"], abs=0.02)


@pytest.mark.parametrize("form", ["exponential", "rational", "gaussian"])
def test_a_weakening_contact_has_less_torque_at_high_speed(plain, form):
    weak = _numbers(("velocity_weakening", {"form": form, "share": 0.3, "speed": 4.0}))
    fast = [i for i in range(2, 7) if math.isfinite(weak[f"law_down_{i}"])]
    assert len(fast) >= 3
    for i in fast:
        # from half to all of the share is lost beyond the speed that goes with it
        assert -0.35 < weak[f"law_down_{i}"] - 1.0 < -0.1
    assert weak["kinetic"] < plain["kinetic"] - 0.1
    assert weak["trough"] < plain["trough"]


def test_scatter_of_the_critical_torque_is_scatter_of_the_peaks(plain):
    scattered = _numbers(("critical_torque_scatter", {"scatter": 0.1, "correlation": 0.0}))
    assert scattered["peak_spread"] > 3 * plain["peak_spread"]
    assert scattered["interval_spread"] > plain["interval_spread"] + 0.05
    assert scattered["kinetic_spread"] < 0.05  # sliding is as it was


def test_a_stiffer_elastomer_than_the_rig_file_has_is_seen_in_stick(plain):
    stiff = replace(RIG, fits=(replace(FIT, elastomer_stiffness=1.15 * FIT.elastomer_stiffness),))
    found = _numbers(rig=stiff)
    assert found["stiffness_all"] / plain["stiffness_all"] == pytest.approx(1.15, abs=0.05)
    assert found["kinetic"] == pytest.approx(plain["kinetic"], abs=0.02)


def test_a_shaft_that_turns_the_other_way_makes_the_same_contact():
    # all of the rig is odd: torque and motion change sign together
    condition = at(2.0)
    recording = run(condition, seconds=SECONDS)
    samples = recording.samples * -1.0
    mirrored = replace(recording, samples=samples, condition=at(-2.0))
    found = torque_transfer_functions(RIG, 0.279e-3, 2214.0)
    one, other = summary(recording, RIG, found), summary(mirrored, RIG, found)
    contact = [name for name in one if name.startswith(("contact", "angle"))]
    assert len(contact) > 60
    for name in contact:
        assert other[name] == pytest.approx(one[name], abs=1e-6, nan_ok=True), name


def test_a_table_has_a_row_a_recording_and_no_infinite_number():
    recordings = [run(at(v), seed=i) for i, v in enumerate((1.0, 2.0, 2.0))]
    table = case_table(recordings, RIG)
    assert table.measured.shape == table.nominal.shape == table.scatter.shape
    assert table.measured.shape == (3, len(table.names))
    assert list(table.names) == sorted(set(table.names))
    for rows in (table.measured, table.nominal, table.scatter):
        assert not np.isinf(rows).any()
        assert np.isfinite(rows).mean() > 0.8
    assert np.array_equal(table.nominal[1], table.nominal[2], equal_nan=True)
    # repeats of the rig file itself are what they are compared with
    z = (table.measured - table.nominal) / (table.scatter + 0.02 * np.abs(table.nominal) + 1e-3)
    assert np.nanmedian(np.abs(z)) < 1.5
