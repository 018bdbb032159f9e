"""Rigs with six laws of friction, and how well `bushing-noise identify` identifies them.

Six recordings of one rig with one law, and what its user knows of it: the supports and, from
drawings, the two inertias; nothing of the bushing. The truth of a number is that of the rig, about
which each recording scatters by 2 %. Of the laws three stick truly and run on the tables of
`tests.blind.kernel`; three creep. The logarithm of rate and state spans three decades, of which a
cycle spans one: its drop is the larger.

Seeds below 100 are for fitting and choosing what the identification has of its own (widths of
intervals, margin between laws); those from 100 on are for reporting.
"""

from __future__ import annotations

import itertools
import json
import math
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import contact, kernel
from .cases import NOISE, sampled, write_wav
from .generate import each
from .laws import Law, contact_of
from .rig import FIXED, Parameters, plain, turn
from .score import resolve

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .rig import Setup, Turned

__all__ = ["KNOWN", "LAWS", "Made", "draw_law", "make_rig", "score_rigs", "turn_with", "write_rig"]

LAWS = ("constant", "stribeck", "rate_and_state", "memory", "bristle", "ageing")

_CREEPING = {
    "bristle": contact.BRISTLE, "rate_and_state": contact.RATE_AND_STATE, "memory": contact.MEMORY,
}  # fmt: skip
_SLIDING = np.linspace(0.0, kernel.LARGEST_SLIDING, kernel.POINTS)
_AGE = kernel.LOWEST_AGE * 10.0 ** (kernel.AGE_DECADES * np.linspace(0.0, 1.0, kernel.POINTS))


def draw_law(name: str, rng: np.random.Generator) -> Law:
    """Draw a law of a kind, about what makes rubber on steel squeal and stick."""

    def between(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    drawn = {
        "constant": dict,
        "stribeck": lambda: {"speed": between(1.0, 10.0)},
        "ageing": lambda: {"time": between(5e-4, 4e-3)},
        "bristle": lambda: {
            "stiffness": between(1200.0, 3000.0), "viscous": between(2e-5, 1e-4),
            "speed": between(1.0, 6.0),
        },
        "rate_and_state": lambda: {
            "stiffness": between(2500.0, 6000.0), "viscous": between(2e-5, 1e-4),
            "renewal": between(1e-4, 4e-4), "time": between(1e-5, 4e-5),
            "direct": between(0.001, 0.004),
        },
        "memory": lambda: {
            "stiffness": between(1000.0, 2500.0), "viscous": between(3e-5, 1e-4),
            "renewal": between(1.5e-4, 6e-4), "time": between(3e-4, 2e-3),
            "weakening": between(0.05, 0.2), "speed": between(3.0, 20.0),
        },
    }  # fmt: skip
    return Law(name, drawn[name]())


def turn_with(setup: Setup, law: Law) -> Turned:
    """Run a setup that no effect has changed with a law."""
    p, v = setup.p, law.values
    drop = p[kernel.T_CRIT] - p[kernel.T_KIN]
    if law.name == "constant":
        return turn(setup)
    if law.name == "stribeck":
        setup.weakening = 1.0 + drop / p[kernel.T_KIN] * np.exp(-_SLIDING / v["speed"])
        return turn(setup)
    if law.name == "ageing":
        setup.ageing = 1.0 - np.exp(-((_AGE / v["time"]) ** 0.7))
        return turn(setup)
    setup.law = _CREEPING[law.name]
    setup.contact = contact_of(v, drop=2.5 if law.name == "rate_and_state" else 1.0)
    return turn(setup)


_FITS = {
    0.178: (430.0, 5.6, 4.0, 2.5),
    0.279: (665.0, 10.7, 8.0, 4.0),
    0.381: (1011.0, 26.5, 20.0, 7.0),
}
_SUPPORTS = {2214.0: 0.105, 3745.0: 0.085, FIXED: 0.085}
_RATES = (30_000, 32_000, 48_000)
_SETTLING = 0.35
_LEAST_RATE = 75e3
N_RECORDINGS = 6
_TRIES = 5
KNOWN = ("elastomer_inertia_kgm2", "clamp_inertia_kgm2")


@dataclass(frozen=True, eq=False)
class Made:
    """A rig as it was recorded: conditions as (speed, fit, support), samples of torque and angle.

    `levels` has, for each recording, the torque at which the contact broke and that at which it
    slid, free of noise.
    """

    law: Law
    truth: dict[str, object]
    conditions: tuple[tuple[float, float, float], ...]
    rate: int
    recordings: tuple[NDArray[np.float32], ...]


def make_rig(seed: int, index: int, *, recordings: int = N_RECORDINGS) -> Made:
    """Draw and record rig `index` of a seed; laws come in turn."""
    rng = np.random.default_rng([seed, index, 77])
    law = draw_law(LAWS[index % len(LAWS)], rng)
    wide = np.exp(0.08 * rng.standard_normal(12))
    fits = {f: (k * wide[i], c * wide[3 + i], t * wide[3 + i], top)
            for i, (f, (k, c, t, top)) in enumerate(_FITS.items())}  # fmt: skip
    damping = {kb: c * wide[6 + i] for i, (kb, c) in enumerate(_SUPPORTS.items())}
    inertias = (wide[9] / 65000.0, wide[10] / 1200.0)
    chosen_fits, supports = _some(_FITS, rng), _some(_SUPPORTS, rng)
    rate = int(rng.choice(_RATES))
    conditions, samples, runs = [], [], []
    for k in range(recordings):
        fit = chosen_fits[k % len(chosen_fits)]
        support = supports[k // 2 % len(supports)]
        top = fits[fit][3]
        speed = round(float(np.exp(rng.uniform(np.log(0.6), np.log(top)))), 1)
        stiffness, critical, kinetic, _ = fits[fit]
        rig = Parameters(*inertias, stiffness, support, damping[support], critical, kinetic)
        decimation = int(np.ceil(_LEAST_RATE / rate))
        for _ in range(_TRIES):  # who records a quiet rig turns it slower
            once, true_speed, chance = _scattered(rig, speed, [seed, index, k])
            setup = plain(
                once, true_speed, rate=float(rate * decimation), seconds=1.0, settling=_SETTLING
            )
            turned = turn_with(setup, law)
            if np.std(turned.torque) > 0.03 * np.mean(turned.torque):
                break
            speed = max(round(0.7 * speed, 1), 0.4)
        conditions.append((speed, fit, support))
        angle = turned.states[setup.settle :, kernel.SURFACE_ANGLE]
        signals = {"torque": turned.torque, "angle": angle - angle[0]}
        samples.append(np.stack([
            sampled(signals[n], decimation, NOISE[n], n, chance) for n in signals
        ]))  # fmt: skip
        runs.append(_levels(turned))
    truth = {
        "law": law.name, "law_values": law.values, "inertias": inertias,
        "fits": {str(f): fits[f][:3] for f in chosen_fits},
        "damping": {str(kb): damping[kb] for kb in supports},
        "levels": runs,
    }  # fmt: skip
    return Made(law, truth, tuple(conditions), rate, tuple(samples))


def _some(offered: dict, rng: np.random.Generator) -> list[float]:
    return [float(x) for x in rng.choice(list(offered), int(rng.integers(1, 3)), replace=False)]


def _scattered(rig: Parameters, speed: float, where: list[int]):
    rng = np.random.default_rng([*where, 5])
    many = np.exp(0.02 * rng.standard_normal(5))
    small = np.exp(0.004 * rng.standard_normal(3))
    kinetic = rig.kinetic_torque * many[1]
    fixed = rig.support_stiffness < 0.0
    once = replace(
        rig, elastomer_stiffness=rig.elastomer_stiffness * many[0], kinetic_torque=kinetic,
        critical_torque=kinetic + (rig.critical_torque - rig.kinetic_torque) * many[2],
        damping=rig.damping * many[3], elastomer_inertia=rig.elastomer_inertia * many[4],
        support_stiffness=FIXED if fixed else rig.support_stiffness * small[0],
        clamp_inertia=rig.clamp_inertia * small[1],
    )  # fmt: skip
    return once, speed * small[2], np.random.default_rng([*where, 6])


def _levels(turned) -> dict[str, float]:
    """What the contact did in truth: the torque at the end of each stick, that of fast sliding."""
    states = turned.states[turned.settle :]
    drag, speed = states[:, kernel.FRICTION], states[:, kernel.SURFACE_SPEED]
    sliding = speed - states[:, kernel.V1]
    slides = sliding > speed
    fast = sliding > np.maximum(1.1 * speed, 0.6 * np.quantile(sliding, 0.995))
    begins = np.flatnonzero(np.diff(slides.astype(int)) == 1)
    torque = states[:, kernel.TORQUE]
    peaks = [torque[a:b].max() for a, b in itertools.pairwise(begins)]
    return {
        "critical": float(np.median(peaks)) if len(peaks) > 1 else float(torque.mean()),
        "kinetic": float(np.mean(drag[fast])) if fast.any() else float(np.mean(drag)),
        "slips": len(peaks),
        "oscillation": float(np.std(torque) / np.mean(torque)),
    }


def write_rig(made: Made, folder: Path) -> None:
    """Write recordings with sidecars, and ``known.toml``, what the user knows."""
    folder.mkdir(parents=True)
    for k, ((speed, fit, support), samples) in enumerate(
        zip(made.conditions, made.recordings, strict=True)
    ):
        write_wav(folder / f"run{k + 1:02d}.wav", samples, made.rate)
        sidecar = {
            "channels": [{"name": "torque", "unit": "N m"}, {"name": "angle", "unit": "rad"}],
            "conditions": {
                "speed_rad_s": speed, "interference_mm": fit,
                "support_stiffness_Nm_rad": support if support > 0.0 else None,
            },
            "calibrated": True,
        }  # fmt: skip
        text = json.dumps(sidecar, indent=1) + "\n"
        (folder / f"run{k + 1:02d}.json").write_text(text, encoding="utf-8")
    inertias = made.truth["inertias"]
    lines = [f"{name} = {value:.6g}" for name, value in zip(KNOWN, inertias, strict=True)]
    (folder / "known.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")


IDENTIFY = "tests.helpers.diagnosed:identification_json"
"""What ``bushing-noise identify`` calls."""


def score_rigs(seed: int, rigs: int, workers: int) -> dict[str, Any]:
    """Identify rigs and compare with the truth: errors and coverage of numbers, laws, seconds."""
    with each(workers) as mapped:
        rows = list(mapped(_one, [(seed, i) for i in range(rigs)]))
    good = [row for row in rows if "failed" not in row]
    summary: dict[str, Any] = {"identified": len(good), "of": rigs}
    for name in ("elastomer_stiffness", "critical_torque", "kinetic_torque", "damping"):
        of_name = [n for row in good for n in row["numbers"] if n["name"] == name]
        errors = np.abs([n["error"] for n in of_name] or [math.nan])
        summary[name] = {
            "n": len(of_name), "median_error": float(np.median(errors)),
            "p90_error": float(np.quantile(errors, 0.9)),
            "coverage": float(np.mean([n["inside"] for n in of_name] or [math.nan])),
        }  # fmt: skip
    laws = [(row["law"], row["picked"]) for row in good]
    return summary | {"right_law": sum(a == b for a, b in laws), "laws": laws, "each": rows}


def _one(job: tuple[int, int]) -> dict[str, Any]:
    made = make_rig(*job)
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder) / "data"
        write_rig(made, data)
        started = time.perf_counter()
        try:
            answer = dict(resolve(IDENTIFY)(data, data / "known.toml"))
        except Exception as error:  # a rig that is refused counts as one that failed
            return {"index": job[1], "law": made.law.name, "failed": str(error)[:200]}
        seconds = time.perf_counter() - started
    numbers = [(number, _truth(number, made)) for number in answer["numbers"]]
    return {
        "index": job[1], "law": made.law.name, "picked": answer["law"], "seconds": seconds,
        "numbers": [
            {
                "name": number["name"], "error": math.log(number["value"] / true),
                "inside": bool(number["low"] <= true <= number["high"]),
            }
            for number, true in numbers if true is not None
        ],
    }  # fmt: skip


def _truth(number: dict[str, Any], made: Made) -> float | None:
    """Return what a number truly is; None of those that the user knew."""
    name, truth, fit = number["name"], made.truth, str(number.get("interference_mm"))
    if name == "elastomer_stiffness":
        return truth["fits"][fit][0]
    if name == "damping":
        support = number["support_stiffness_Nm_rad"]
        return truth["damping"][str(FIXED if support == "fixed" else float(support))]
    if name not in ("critical_torque", "kinetic_torque"):
        return None
    if made.law.name == "constant":
        return truth["fits"][fit][1 if name == "critical_torque" else 2]
    levels = [
        level[name.split("_")[0]]
        for level, (_, of, _) in zip(truth["levels"], made.conditions, strict=True)
        if str(of) == fit and level["slips"] > 1
    ]
    return float(np.exp(np.mean(np.log(levels)))) if levels else None
