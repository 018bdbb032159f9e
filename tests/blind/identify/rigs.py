"""Rigs to be identified: six recordings of one rig with one law, and what its user knows of it.

The user knows the supports and, from drawings, the two inertias; nothing of the bushing. The truth
of a number is that of the rig, about which each recording scatters by 2 %, as in `tests.blind`.
"""

from __future__ import annotations

import itertools
import json
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from .. import kernel
from ..cases import NOISE, sampled
from ..files import write_wav
from ..rig import FIXED, Parameters, plain
from .laws import LAWS, Law, draw_law, turn_with

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = ["KNOWN", "Made", "make_rig", "write_rig"]

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


def make_rig(
    seed: int, index: int, *, scatter: float = 1.0, recordings: int = N_RECORDINGS
) -> Made:
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
            once, true_speed, chance = _scattered(rig, speed, scatter, [seed, index, k])
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
            sampled(signals[n], decimation, scatter * NOISE[n], n, chance)
            if scatter else signals[n][::decimation].astype(np.float32)
            for n in signals
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


def _scattered(rig: Parameters, speed: float, scatter: float, where: list[int]):
    rng = np.random.default_rng([*where, 5])
    many = np.exp(0.02 * scatter * rng.standard_normal(5))
    small = np.exp(0.004 * scatter * rng.standard_normal(3))
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
