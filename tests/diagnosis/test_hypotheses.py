"""Sets of causes are told by their joint probability, and by cases simulated of the very rig."""

from concurrent.futures.process import BrokenProcessPool

import numpy as np
import pytest
from hypothesis import given, strategies as st

from models.condition import FIXED
from models.errors import ParameterError
from noise.diagnosis.case import Case
from noise.diagnosis.causes import local_cases as local
from noise.diagnosis.causes.hypotheses import fit_local_model, local_answer
from noise.diagnosis.causes.joint import joint_probabilities, marginals
from noise.diagnosis.causes.local_cases import LocalCache
from noise.diagnosis.causes.posterior import CAUSES, load_posterior
from noise.diagnosis.evidence.summary import case_table
from sim.effects import EFFECTS
from sim.effects.effect import Effect, Stage
from sim.parameters import Parameter
from tests.helpers.small_rigs import RIG, at, run

CONDITIONS = [at(v, FIXED) for v in (1.0, 1.6, 2.5)]
SHORT = CONDITIONS[:1]  # where what is told does not matter
HUM = ("mains_hum", {"amount": 1.0})
EXCLUSIVE = ("none", "parameters", "unknown")


@pytest.fixture(autouse=True)
def cache_folder(tmp_path, monkeypatch):
    monkeypatch.setattr("noise.diagnosis.causes.local_cases._folder", lambda: tmp_path)
    return tmp_path


@pytest.fixture(scope="module")
def posterior():
    return load_posterior()


def _case(*effects, library=EFFECTS, conditions=CONDITIONS):
    recordings = [run(c, *effects, seed=60 + i, library=library) for i, c in enumerate(conditions)]
    return Case(RIG, tuple(f"run{i}" for i in range(len(recordings))), tuple(recordings))


def _answers(case, posterior, library=EFFECTS, **options):
    table = case_table(case.recordings, case.rig, library=library)
    first = joint_probabilities(posterior.probabilities(table))
    answer, told = local_answer(
        case, table, posterior, first, library=library, workers=1, **options
    )
    return first, answer, told


def _likeliest(joint):
    return set(max(joint, key=joint.get))


def _rectified(signals, _rate, _form, values, _rng):
    def half(x):
        away = x - x.mean()
        return x.mean() + (1.0 - values["share"]) * away + values["share"] * np.abs(away)

    return signals | {name: half(signals[name]) for name in ("torque", "acceleration", "pressure")}


RECTIFIER = Effect(
    "rectifier", Stage.MEASUREMENT, ("plain",),
    {"share": Parameter(0.2, "", 0.0, 1.0, "of all signals that is rectified")}, "share",
    sensors=_rectified,
)  # fmt: skip


@given(
    st.fixed_dictionaries(
        {cause: st.floats(0.0, 1.0) for cause in (*EXCLUSIVE, "clipping", "mains_hum", "wow")}
    )
)
def test_probabilities_of_all_sets_sum_to_one_and_an_impossible_cause_is_in_none(chances):
    if not any(chances.values()):
        chances["none"] = 1.0
    joint = joint_probabilities(chances)
    assert sum(joint.values()) == pytest.approx(1.0)
    assert list(joint.values()) == sorted(joint.values(), reverse=True)
    assert all(chances[cause] > 0 for h in joint for cause in h if joint[h] > 0.0)


def test_a_cause_is_about_as_probable_in_the_sets_as_by_itself():
    sure = dict.fromkeys(CAUSES, 0.001) | {"clipping": 0.95, "mains_hum": 0.4}
    single = marginals(joint_probabilities(sure))
    assert single["clipping"] == pytest.approx(0.95, abs=0.05)
    assert single["mains_hum"] == pytest.approx(0.4, abs=0.05)
    assert (
        marginals(joint_probabilities(dict.fromkeys(CAUSES, 0.001) | {"none": 0.9}))["none"] > 0.9
    )


def test_two_plain_causes_are_a_pair_and_doubtful_ones_are_not():
    plain = dict.fromkeys(CAUSES, 0.01) | {"clipping": 0.9, "mains_hum": 0.8}
    assert _likeliest(joint_probabilities(plain)) == {"clipping", "mains_hum"}
    assert _likeliest(joint_probabilities(plain | {"mains_hum": 0.3})) == {"clipping"}


def test_without_cases_a_set_scores_the_sum_of_its_members():
    pair = frozenset({"clipping", "mains_hum"})
    sets = (frozenset(), frozenset({"clipping"}), frozenset({"mains_hum"}), pair)
    odds = np.full(len(CAUSES), -3.0)
    odds[[CAUSES.index("clipping"), CAUSES.index("mains_hum")]] = 2.0, 1.0
    model = fit_local_model(np.zeros((0, len(CAUSES))), [], sets)
    assert model.log_likelihoods(odds).tolist() == pytest.approx([-3.0, 2.0, 1.0, 3.0])


def test_cases_teach_what_a_pair_looks_like_where_its_members_hide_each_other():
    rng = np.random.default_rng(0)
    one, other = frozenset({"clipping"}), frozenset({"mains_hum"})
    sets = (frozenset(), one, other, one | other)
    centres = {sets[0]: (-4.0, -4.0), one: (4.0, -4.0), other: (-4.0, 4.0), sets[3]: (4.0, -2.0)}
    columns = [CAUSES.index("clipping"), CAUSES.index("mains_hum")]

    def seen(cause):
        odds = np.zeros(len(CAUSES))
        odds[columns] = centres[cause] + 0.5 * rng.standard_normal(2)
        return odds

    causes = [cause for cause in sets for _ in range(15)]
    model = fit_local_model(np.array([seen(cause) for cause in causes]), causes, sets)
    told = [sets[int(np.argmax(model.log_likelihoods(seen(cause))))] for cause in causes]
    assert np.mean([t == cause for t, cause in zip(told, causes, strict=True)]) > 0.9
    blind = fit_local_model(np.zeros((0, len(CAUSES))), [], sets)
    assert sets[int(np.argmax(blind.log_likelihoods(seen(sets[3]))))] == one


def test_a_rig_that_hums_is_told_by_its_own_cases(posterior, monkeypatch):
    monkeypatch.setattr("noise.diagnosis.causes.hypotheses.SHORTLIST", 3)
    _, answer, _ = _answers(_case(HUM), posterior)
    assert sum(answer.values()) == pytest.approx(1.0)
    assert _likeliest(answer) == {"mains_hum"}
    assert marginals(answer)["mains_hum"] > 0.8


def test_an_effect_of_the_users_own_gets_a_probability_like_the_others(posterior, monkeypatch):
    monkeypatch.setattr("noise.diagnosis.causes.hypotheses.SHORTLIST", 3)
    library = {**EFFECTS, "rectifier": RECTIFIER}
    _, answer, _ = _answers(
        _case(("rectifier", {"share": 0.6}), library=library, conditions=SHORT), posterior, library
    )
    chances = marginals(answer)
    # What is rectified is cut off as well: the fits tell the two apart.
    ranked = sorted(set(chances) - set(EXCLUSIVE), key=lambda name: -chances[name])
    assert set(ranked[:2]) == {"rectifier", "clipping"}
    _, other, _ = _answers(_case(HUM, conditions=SHORT), posterior, library)
    assert marginals(other)["rectifier"] < 0.5 * chances["rectifier"]


@pytest.mark.parametrize("sure", [0.0, 2.0])
def test_effects_of_the_users_own_leave_the_others_as_probable_beside_each_other(
    posterior, monkeypatch, sure
):
    monkeypatch.setattr("noise.diagnosis.causes.hypotheses.SHORTLIST", 2)
    monkeypatch.setattr("noise.diagnosis.causes.hypotheses.SURE", sure)
    case = _case(HUM, conditions=SHORT)
    _, without, _ = _answers(case, posterior)
    _, beside, _ = _answers(case, posterior, {**EFFECTS, "rectifier": RECTIFIER})
    assert sum(beside.values()) == pytest.approx(1.0)
    left = 1.0 - marginals(beside)["rectifier"]
    others = {h: p / left for h, p in beside.items() if "rectifier" not in h}
    assert others == pytest.approx(without)


@pytest.fixture
def doubtful(monkeypatch):
    """The first answer is never sure enough, and two effects are in question."""
    monkeypatch.setattr("noise.diagnosis.causes.hypotheses.SURE", 2.0)
    monkeypatch.setattr("noise.diagnosis.causes.hypotheses.SHORTLIST", 2)


def _never(*_arguments, **_options):
    raise AssertionError("simulated")


@pytest.mark.usefixtures("doubtful")
def test_a_second_diagnosis_starts_from_the_first(posterior, monkeypatch, cache_folder):
    case = _case(conditions=SHORT)
    _, before, _ = _answers(case, posterior)
    (kept,) = cache_folder.rglob("*.npz")
    assert kept.stat().st_size < 50_000
    with monkeypatch.context() as patched:
        patched.setattr(local, "run_signals", _never)
        assert _answers(case, posterior)[1] == before
    kept.write_bytes(b"half a file")
    assert _answers(case, posterior)[1] == before


def test_nothing_is_simulated_where_the_first_answer_is_sure(posterior, monkeypatch):
    monkeypatch.setattr(local, "run_signals", _never)
    case = _case()
    table = case_table(case.recordings, case.rig)
    sure = {frozenset({"mains_hum"}): 0.9, frozenset({"unknown"}): 0.1}
    assert local_answer(case, table, posterior, sure) == (sure, "")


@pytest.mark.usefixtures("doubtful")
def test_cases_that_cannot_be_simulated_leave_the_first_answer_and_are_told(posterior, monkeypatch):
    def broken(*_arguments, **_options):
        raise ParameterError("no such rig")

    monkeypatch.setattr(local, "run_signals", broken)
    first, answer, told = _answers(_case(), posterior)
    assert answer == first
    assert "cannot be simulated" in told


def test_another_rig_has_local_cases_of_its_own_and_old_ones_go(posterior, monkeypatch):
    monkeypatch.setattr("noise.diagnosis.causes.local_cases._MOST", 2)
    files = [LocalCache.of((name,), posterior) for name in ("one", "two", "three")]
    assert len({file.path for file in files}) == 3
    known = {(frozenset({"clipping"}), 1): np.ones(3)}
    for file in files:
        file.write(known)
    assert files[0].read() == {}
    (entry,) = files[2].read().items()
    assert entry[0] == (frozenset({"clipping"}), 1)
    assert entry[1].tolist() == [1.0, 1.0, 1.0]


def test_two_processes_make_the_cases_of_one(posterior, monkeypatch):
    monkeypatch.setattr(LocalCache, "read", lambda _cache: {})
    case = _case(conditions=SHORT)
    bench = local.bench_of(case, case_table(case.recordings, case.rig))
    wanted = [(frozenset(), i) for i in range(8)] + [(frozenset({"clipping"}), i) for i in range(8)]
    one, two = (
        [made.odds.tolist() for made in local.local_cases(bench, posterior, wanted, workers=n)]
        for n in (1, 2)
    )
    assert one == two


def test_of_long_recordings_a_second_is_simulated(posterior):
    long = run(CONDITIONS[0], seed=3, seconds=1.3)
    case = Case(RIG, ("long",), (long,))
    table = case_table(case.recordings, case.rig)
    bench = local.bench_of(case, table)
    assert bench.runs[0].seconds == pytest.approx(local.LONGEST)
    assert bench.table is not table


def test_of_many_recordings_some_are_simulated_from_the_first_to_the_last(posterior, monkeypatch):
    monkeypatch.setattr(local, "MOST", 2)
    case = _case()
    bench = local.bench_of(case, case_table(case.recordings, case.rig))
    assert [one.condition for one in bench.runs] == [CONDITIONS[0], CONDITIONS[-1]]
    assert len(bench.table.measured) == 2


def test_processes_that_are_ended_lose_no_cases(posterior, monkeypatch):
    monkeypatch.setattr(LocalCache, "read", lambda _cache: {})
    monkeypatch.setattr(local, "_SEVERAL", 1)
    case = _case(conditions=SHORT)
    bench = local.bench_of(case, case_table(case.recordings, case.rig))
    wanted = [(frozenset(), i) for i in range(2)]

    class Ended:
        def __init__(self, **_options):
            """Begin."""

        def __call__(self, _work):
            raise BrokenProcessPool

    monkeypatch.setattr("joblib.Parallel", Ended)
    assert len(local.local_cases(bench, posterior, wanted, workers=2)) == 2
