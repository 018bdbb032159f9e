"""Cases of the library's own forms: made by `sim`, laid out as blind cases are, answers apart.

A diagnosis that is scored on these as well as on blind cases shows what it loses to forms, and to a
rig, that its library does not have. Conditions, the nominal rig, scatter, gains and noise are drawn
by the blind check, and the structure is that of its second rig, measured once more; all that moves
is the simulator's. Strangers, which `sim` does not have, are passed over.

``python -m tests.helpers.own_cases --out DIR --seed N --cases N``
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np

from models.rig import Fit, LawSpec, Rig
from models.rig_file import load_rig
from sim.acquisition import Acquisition
from sim.effects import EFFECTS
from sim.run import simulate
from tests.blind.cases import (
    CHANNELS,
    NOISE,
    Case,
    answer_of,
    responses_of,
    sampled,
    structures_of,
    write_case,
)
from tests.blind.design import Design, draw_design
from tests.blind.effects import DEVELOPMENT, Form
from tests.blind.gap import gap_between, repeats_of
from tests.blind.generate import each

__all__ = ["STRONG", "own_case", "own_design", "write_own_cases"]

STRONG = {
    "amplitude_softening": 0.5, "background_noise": 4.0, "beam_modes": 5.0,
    "channel_delay": 5e-4, "clipping": 0.8, "critical_torque_scatter": 0.4,
    "frictional_heating": 0.02, "gain_error": 0.5, "mains_hum": 4.0, "mount_resonance": 1.0,
    "partial_slip": 0.9, "plate_modes": 3.0, "room_reflections": 1.5, "shaft_compliance": 8e-4,
    "slip_pulse": 120.0, "speed_fluctuation": 0.15, "static_ageing": 0.9, "transfer_film": 1.0,
    "velocity_strengthening": 0.5, "velocity_weakening": 0.4, "viscoelastic_stiffness": 0.9,
}  # fmt: skip
"""What a strength of 1 is, in the parameter that is an effect's strength."""

_OWN = "own"


def own_design(seed: int, index: int) -> Design | None:
    """Return the development design of this index with own forms; None for a stranger."""
    design = draw_design(seed, index, DEVELOPMENT)
    if design.kind == "stranger":
        return None
    forms = []
    for j, (form, strength) in enumerate(design.forms):
        effect = EFFECTS[form.effect]
        rng = design.stream(11, j)
        name = effect.forms[int(rng.integers(len(effect.forms)))]
        forms.append((replace(form, name=name, kept_for=_OWN), strength))
    return replace(design, forms=tuple(forms))


def _spec(form: Form, strength: float) -> LawSpec:
    effect = EFFECTS[form.effect]
    return LawSpec(
        form.effect, {"form": form.name, effect.strength: strength * STRONG[form.effect]}
    )


def _record(design: Design, k: int, rig: Rig, on: frozenset[str]) -> np.ndarray:
    condition = design.conditions[k]
    chance, true = design.stream(7, k), design.true(condition, k)
    support = condition.support if condition.support > 0.0 else np.inf
    fit = Fit(
        interference=1e-3 * condition.interference_mm,
        elastomer_stiffness=true.elastomer_stiffness,
        critical_torque=true.critical_torque,
        kinetic_torque=true.kinetic_torque,
        damping={support: true.damping},
    )
    rig = replace(
        rig,
        elastomer_inertia=true.elastomer_inertia,
        clamp_inertia=true.clamp_inertia,
        fits=(fit,),
        effects=tuple(_spec(form, a) for form, a in design.forms if form.effect in on),
    )
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*is missing from the simulated")
        run = simulate(
            rig,
            condition.speed * float(np.exp(0.004 * chance.standard_normal())),
            interference=fit.interference,
            support_stiffness=support,
            seconds=design.seconds,
            acquisition=Acquisition(rate=design.rate, noise={}),
            rng=design.stream(9, k),
        )
    by_name = dict(zip(run.recording.channel_names, run.recording.samples, strict=True))
    return np.stack([sampled(by_name[name], 1, NOISE[name], name, chance) for name in CHANNELS])


def own_case(design: Design) -> Case:
    """Run a case by `sim`; its answer holds the gap, too."""
    structures = structures_of(design)
    once, again = (responses_of(design, structures, n) for n in (0, 1))
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder) / "case"
        silence = (np.zeros((4, 2), np.float32),) * len(design.conditions)
        write_case(Case(design, silence, again, {}), data, None)
        rig = load_rig(data / "rig.toml")

    names = frozenset(form.effect for form, _ in design.forms)

    def recordings(of: Design, on: frozenset[str]) -> tuple[np.ndarray, ...]:
        return tuple(_record(of, k, rig, on) for k in range(len(of.conditions)))

    found = recordings(design, names)
    answer = answer_of(design) | {"set": _OWN, "gap": 1.0, "gap_alone": {}}
    if design.kind != "none":
        plain = recordings(replace(design, offsets={}), frozenset())
        where = repeats_of(design, plain), design.rate
        answer["gap"] = gap_between(found, plain, *where)
        if len(names) > 1:
            answer["gap_alone"] = {
                name: gap_between(recordings(design, frozenset({name})), plain, *where)
                for name in sorted(names)
            }
    return Case(design, found, once, answer)


def _write(job: tuple[Path, int, int]) -> None:
    out, seed, index = job
    design = own_design(seed, index)
    if design is not None:
        name = f"case-{index + 1:04d}"
        write_case(own_case(design), out / "data" / name, out / "answers" / f"{name}.json")


def write_own_cases(out: Path, seed: int, cases: int, workers: int) -> float:
    """Write the first cases of a seed that are no strangers; return the seconds it took."""
    if (out / "data").exists():
        raise SystemExit(f"{out / 'data'} is there already; name another folder")
    begun = time.perf_counter()
    with each(workers) as mapped:
        list(mapped(_write, [(out, seed, index) for index in range(cases)]))
    return time.perf_counter() - begun


def main(arguments: list[str] | None = None) -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(prog="python -m tests.helpers.own_cases")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args(arguments)
    seconds = write_own_cases(given.out, given.seed, given.cases, given.workers)
    sys.stderr.write(f"{given.cases} cases less strangers in {seconds:.0f} s\n")


if __name__ == "__main__":
    main()
