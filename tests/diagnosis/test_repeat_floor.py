"""The floor is what repeats differ by: chance stays below it, a changed rig does not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binomtest, kstest

from models.condition import Condition, KnownCondition
from models.recording import Channel, Recording
from models.rig_file import load_material_rig, load_rig
from noise.diagnosis.case import read_case
from noise.diagnosis.floor import floor_widening, reference, references_of
from noise.diagnosis.gap import gap_of
from noise.diagnosis.signature import GROUPS, NAMES, signature
from noise.diagnosis.simulated.repeats import (
    Scatter,
    condition_key,
    nominal_repeats,
    plan_repeat,
    repeat_motion,
)
from noise.diagnosis.simulated.transfer_functions import TransferFunctionCache
from tests.blind.cases import run_case, write_case
from tests.blind.design import draw_design
from tests.blind.effects import DEVELOPMENT
from tests.helpers.small_rigs import gap_of_case

pytestmark = pytest.mark.filterwarnings("ignore:.*is missing from the simulated")

RIG = load_material_rig("fluorocarbon-thesis")
AT = [Condition(speed=v, interference=0.279e-3, support_stiffness=3745.0) for v in (1.0, 2.5)]


@pytest.fixture(scope="module")
def transfers():
    return TransferFunctionCache(RIG)


def _runs(transfers, seeds, *, rig=RIG, at=AT[0], seconds=0.4, scatter=None):
    template = Recording(np.zeros((1, round(30e3 * seconds))), 30e3, (Channel("torque"),), at)
    return nominal_repeats(template, rig, transfers, seeds, scatter)


def _signatures(*args, **options):
    return [signature(run) for run in _runs(*args, **options)]


def repeat_gap(recordings, repeats):
    signatures = [signature(recording) for recording in recordings]
    return gap_of(signatures, references_of(recordings, signatures, repeats))


def _stiffer(factor):
    return replace(
        RIG,
        fits=tuple(
            replace(fit, elastomer_stiffness=factor * fit.elastomer_stiffness) for fit in RIG.fits
        ),
    )


def _null(index, seed, folder, brief):
    """Second rig, nothing the matter: recordings and rig as a user has them."""
    design = draw_design(seed, index, DEVELOPMENT)
    if brief:
        design = replace(design, conditions=design.conditions[:3], seconds=0.4)
    off = frozenset(form.effect for form, _ in design.forms)
    write_case(run_case(design, off, plain=True), folder, None)
    case = read_case([folder], load_rig(folder / "rig.toml"))
    return case.recordings, case.rig


def _p_values(count, seed, tmp_path, *, brief):
    gaps = []
    for index in range(count):
        recordings, rig = _null(index, seed, tmp_path / str(index), brief)
        gaps.append(gap_of_case(recordings, rig))
    return np.array([g.p_value for g in gaps]), np.array([g.distance for g in gaps])


@pytest.mark.slow
def test_p_values_of_100_second_rigs_without_effects_are_uniform(tmp_path):
    p_values, _ = _p_values(100, 32, tmp_path, brief=False)
    assert kstest(p_values, "uniform").pvalue > 0.05
    assert binomtest(int(np.sum(p_values <= 0.05)), 100, 0.05).pvalue > 0.05


def test_exchanges_give_uniform_p_values_however_few_the_repeats():
    rng = np.random.default_rng(1)
    p_values = []
    for _ in range(100):
        runs = rng.standard_t(3, (2, 7, len(NAMES))) + rng.standard_t(3, (2, 7, 1))
        references = [reference(list(runs[i, 2:])) for i in (0, 0, 1)]
        references[1] = references[0]
        own = [runs[0, 0], runs[0, 1], runs[1, 0]]
        p_values.append(gap_of(own, references).p_value)
    assert kstest(p_values, "uniform").pvalue > 0.05


def test_a_rig_that_is_a_sixth_stiffer_lies_beyond_the_floor(transfers):
    rig = _stiffer(1.16)
    runs = [run for at in AT for run in _runs(transfers, (1, 2), rig=rig, at=at)]
    gap = gap_of_case(runs, RIG)
    assert gap.p_value < 0.05
    assert gap.distance > 1.5


def test_of_repeats_of_one_rig_one_is_as_good_as_simulated(transfers):
    recordings = _runs(transfers, range(9))
    repeats = {condition_key(recordings[0]): [signature(run) for run in recordings[1:]]}
    near = repeat_gap(recordings[:1], repeats)
    assert near.p_value > 0.05
    assert near.distance < 1.5
    far = repeat_gap(_runs(transfers, (0, 1), rig=_stiffer(1.16)), repeats)
    assert far.p_value < 0.05
    assert far.distance > 1.5 * near.distance


def test_repeats_that_differ_more_than_simulated_ones_widen_the_floor(transfers):
    simulated = [_signatures(transfers, range(100, 112), at=at) for at in AT]
    usual = [_signatures(transfers, range(4), at=at) for at in AT]
    loose = [_signatures(transfers, range(4), at=at, scatter=Scatter(0.08)) for at in AT]
    assert floor_widening(list(zip(usual, simulated, strict=True))).tolist() == [1.0] * len(GROUPS)
    assert (floor_widening(list(zip(loose, simulated, strict=True)))[:3] > 1.5).all()


def test_one_long_recording_that_drifts_widens_the_floor(transfers):
    (steady,) = _runs(transfers, (1,), seconds=2.0)
    repeats = {condition_key(steady): _signatures(transfers, range(100, 112), seconds=2.0)}
    gain = np.exp(np.linspace(-1.0, 1.0, steady.samples.shape[1]))
    drifting = replace(steady, samples=steady.samples * gain)
    known = reference(repeats[condition_key(steady)])
    for one, widest in ((steady, 1.0), (drifting, 0.95)):
        narrow = gap_of([signature(one)], [known]).distance
        assert repeat_gap([one], repeats).distance <= widest * narrow


@pytest.mark.parametrize("speed", [10.0, 12.0])
def test_a_rig_that_slides_has_rung_out_before_a_repeat_is_recorded(speed):
    at = KnownCondition(speed, 0.279e-3, 2214.0)
    plan = plan_repeat(load_material_rig("fluorocarbon"), at, (), rate=90e3, seconds=0.5)
    motion = repeat_motion(plan, np.random.default_rng(0))
    assert motion.torque.size == plan.n_settling + plan.n_recorded
    recorded = motion.torque[plan.n_settling :]
    assert recorded.std() < 1e-6 * recorded.mean()
