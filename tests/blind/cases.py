"""Cases: recordings of the second rig with sidecars, its rig file, and the answer kept apart.

Whatever is not the case's effect is drawn alike for all classes, recording by recording: scatter
of the rig, gains, coloured noise, drift and the recorder's clock. The recordings without an effect
need not be kept: `run_case` makes them again, to the bit, when told what to leave off.

A start is how the shaft comes to its speed: a factor of the speed over the time since the recording
began; before it the factor is that of its first instant. The rig settles beforehand unless it
starts from rest.
"""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import resample_poly

from .benches import CHANNELS, KINDS, NOISE
from .design import Design
from .laws import LAWS, contact_of
from .rig import plain, turn
from .structure import Structure, draw_structure

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import NDArray


__all__ = [
    "CHANNELS", "NOISE", "SETTLING", "STARTS", "Case", "answer_of", "responses_of", "rig_text",
    "run_case", "sampled", "structures_of", "support_name", "write_case", "write_npz", "write_wav",
]  # fmt: skip

_LEAST_RATE = 75e3

_LARGEST_WANDER = 4.0
"""Noise, over that of a quiet bench, beyond which only what is white of it grows."""


@dataclass(frozen=True, eq=False)
class Case:
    """A case as it is handed out: samples as channels by time, responses by support."""

    design: Design
    recordings: tuple[NDArray[np.float32], ...]
    responses: dict[float, tuple[dict, dict]]
    answer: dict


def structures_of(design: Design) -> dict[float, Structure]:
    """Draw the structure of each support of a case."""
    supports = sorted({c.support for c in design.conditions})
    return {kb: draw_structure(design.stream(6, i), kb) for i, kb in enumerate(supports)}


def _record(design: Design, k: int, structure: Structure, off: frozenset[str], again: int = 0):
    """Make recording `k`, or a repeat of it; effects named in `off` are left out."""
    condition, bench = design.conditions[k], design.bench
    k += again * len(design.conditions)
    chance = design.stream(7, k)
    decimation = int(np.ceil(_LEAST_RATE / design.rate))
    rate = design.rate * decimation * (1.0 + design.rate_error)
    n = round(design.seconds * design.rate) * decimation
    speed = condition.speed * np.exp(0.004 * chance.standard_normal()) * bench.speed_factor
    starting = design.stream(12, k)
    start = str(starting.choice(KINDS[bench.kind].starts))
    setup = plain(design.true(condition, k), speed, rate=rate, seconds=n / rate,
                  settling=0.0 if start == "rest" else SETTLING)  # fmt: skip
    since = np.maximum(setup.time - setup.settle / rate, 0.0)
    setup.omega *= STARTS[start](starting, design.seconds)(since)
    setup.law = LAWS[bench.law.name].code
    setup.contact = contact_of(bench.law.values)
    for i, listed in enumerate(bench.listed):
        listed.apply(setup, design.stream(13, i, k))
    for j, (form, strength) in enumerate(design.forms):
        if form.effect not in off:
            form.apply(setup, strength, design.stream(8, j), design.stream(9, j, k))
    turned = turn(setup)
    signals = structure.respond(turned)
    for change in setup.structure + setup.radiation:
        change(signals, turned)
    signals = {name: x[setup.settle :] for name, x in signals.items()} | {"torque": turned.torque}
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (setup.omega[1:] + setup.omega[:-1]))]) / rate
    signals["angle"] = angle[setup.settle : setup.n] - angle[setup.settle]
    for change in setup.sensors:
        change(signals, turned)
    return np.stack([
        _stepped(sampled(signals[name], decimation, bench.noise[name], name, chance),
                 bench.step_of(name))
        for name in CHANNELS
    ])  # fmt: skip


def _stepped(samples, step):
    """Samples in steps of a converter, whose range is never left."""
    return samples if step == 0.0 else (step * np.round(samples / step)).astype(np.float32)


def sampled(x, decimation, level, name, rng):
    """Decimate, scale by a gain of 1 % scatter, add noise, its wander and drift; 32-bit samples."""
    y = resample_poly(x, 1, decimation, padtype="line")
    white = rng.standard_normal(y.size)
    f = np.fft.rfftfreq(y.size)
    slow = np.fft.irfft(np.fft.rfft(rng.standard_normal(y.size)) / np.sqrt(1.0 + f / 1e-3), y.size)
    gain = 1.0 if name == "angle" else 1.0 + 0.01 * rng.standard_normal()
    drift = 2.0 * rng.standard_normal() * np.linspace(-1.0, 1.0, y.size)
    loud = level * np.exp(0.1 * rng.standard_normal())
    wander = loud * min(1.0, _LARGEST_WANDER * NOISE[name] / level)
    samples = (gain * y + loud * white + wander * (2.0 * slow + drift)).astype(np.float32)
    if not np.isfinite(samples).all():
        raise RuntimeError(f"{name} is not finite")
    return samples


def run_case(
    design: Design, off: frozenset[str] = frozenset(), *, plain: bool = False, again: int = 0
) -> Case:
    """Run all recordings of a case, the effects in `off` left out; a plain one has no offsets.

    `again` numbers further repeats of them: the same truth, other chance.
    """
    if plain:
        design = replace(design, offsets={})
    structures = structures_of(design)
    recordings = tuple(
        _record(design, k, structures[c.support], off, again)
        for k, c in enumerate(design.conditions)
    )
    return Case(design, recordings, responses_of(design, structures), answer_of(design))


def responses_of(design: Design, structures: dict[float, Structure]):
    """Measure the structures of a case."""
    first = {c.support: c for c in reversed(design.conditions)}
    poor = design.bench.responses == "poor"
    return {
        kb: structures[kb].measured(design.nominal(first[kb]), design.stream(10, i), poor=poor)
        for i, kb in enumerate(sorted(structures))
    }


def answer_of(design: Design) -> dict:
    """Say what is the matter with a case."""
    verdict = [form.effect for form, _ in design.forms]
    if design.kind in ("parameters", "stranger"):
        verdict = ["unknown" if design.kind == "stranger" else "parameters"]
    return {
        "seed": design.seed,
        "index": design.index,
        "set": design.kept_for,
        "block": design.block,
        "bench": design.bench.kind,
        "class": design.kind,
        "verdict": verdict,
        "effects": [
            {"name": form.effect, "form": form.name, "stage": form.stage, "strength": strength}
            for form, strength in design.forms
        ],
        "offsets": design.offsets,
    }


def write_case(case: Case, data: Path, answers: Path | None) -> None:
    """Write a case's folder ``data`` and, apart from it, the file ``answers``."""
    data.mkdir(parents=True)
    design = case.design
    data.joinpath("rig.toml").write_text(rig_text(design), encoding="utf-8")
    channels = design.bench.channels
    for kb, pair in case.responses.items() if "acceleration" in channels else ():
        for name, content in zip(("acceleration", "pressure"), pair, strict=True):
            write_npz(data / f"torque_to_{name}_{support_name(kb)}.npz", content)
    for k, (condition, samples) in enumerate(zip(design.conditions, case.recordings, strict=True)):
        rows = [list(CHANNELS).index(name) for name in channels]
        write_wav(data / f"run{k + 1:02d}.wav", samples[rows], design.rate)
        sidecar = {
            "channels": [{"name": name, "unit": CHANNELS[name]} for name in channels],
            "conditions": {
                "speed_rad_s": condition.speed,
                "interference_mm": condition.interference_mm,
                "support_stiffness_Nm_rad": condition.support if condition.support > 0.0 else None,
                "material": "fluorocarbon",
                "temperature_C": 23.0,
            },
            "calibrated": True,
        }
        text = json.dumps(sidecar, indent=1) + "\n"
        data.joinpath(f"run{k + 1:02d}.json").write_text(text, encoding="utf-8")
    if answers is not None:
        answers.parent.mkdir(parents=True, exist_ok=True)
        answers.write_text(json.dumps(case.answer, indent=1) + "\n", encoding="utf-8")


def support_name(support: float) -> str:
    """How files and tables call a support."""
    return "fixed" if support < 0.0 else f"{support:.0f}"


def write_wav(path: Path, samples: np.ndarray, rate: int) -> None:
    """Write channels by time as 32-bit float; common writers stamp such files with the time."""
    channels, n = samples.shape
    body = np.ascontiguousarray(samples.T, dtype="<f4").tobytes()
    form = struct.pack("<HHIIHHH", 3, channels, rate, 4 * channels * rate, 4 * channels, 32, 0)
    chunks = b"fmt " + struct.pack("<I", len(form)) + form
    chunks += b"fact" + struct.pack("<II", 4, n)
    chunks += b"data" + struct.pack("<I", len(body)) + body
    path.write_bytes(b"RIFF" + struct.pack("<I", 4 + len(chunks)) + b"WAVE" + chunks)


def write_npz(path: Path, content: dict) -> None:
    """Write a measured response."""
    np.savez(path, **content)


def rig_text(design: Design) -> str:
    """Return the rig file of a case: what its user believes of the rig."""
    lines = [
        'name = "bench"',
        'material = "fluorocarbon"',
        f"elastomer_inertia_kgm2 = {design.inertias[0]:.6g}",
        f"clamp_inertia_kgm2 = {design.inertias[1]:.6g}",
        f"effects = [{', '.join(chr(34) + one.text + chr(34) for one in design.bench.listed)}]",
        f"friction = {{ {_friction(design)} }}",
    ]
    by_support = {support_name(kb): c for kb, c in design.damping.items()}
    damping = ", ".join(f'"{name}" = {c:.5g}' for name, c in by_support.items())
    for fit, (stiffness, critical, kinetic) in sorted(design.fits.items()):
        lines += [
            "", "[[fit]]", f"interference_mm = {fit:g}",
            f"elastomer_stiffness_Nm_rad = {stiffness:.6g}", f"critical_torque_Nm = {critical:.6g}",
            f"kinetic_torque_Nm = {kinetic:.6g}", f"damping_Nms_rad = {{ {damping} }}",
        ]  # fmt: skip
    measured = sorted({c.support for c in design.conditions})
    for support in measured if design.bench.responses != "none" else ():
        name = support_name(support)
        lines += [
            "", "[[measured_response]]",
            f"support_stiffness_Nm_rad = {name if support > 0.0 else chr(34) + name + chr(34)}",
            f'torque_to_acceleration = "torque_to_acceleration_{name}.npz"',
            f'torque_to_pressure = "torque_to_pressure_{name}.npz"',
        ]  # fmt: skip
    if design.bench.stated:
        lines += ["", "[sensors]", *_sensors(design)]
    return "\n".join(lines) + "\n"


def _friction(design: Design) -> str:
    """Law and numbers of the friction, as a rig file's table has them."""
    stated = LAWS[design.bench.law.name]
    numbers = [f"{stated.keys[key]} = {x:g}" for key, x in design.bench.law.values.items()]
    return ", ".join([f'law = "{stated.named}"', *numbers])


def _sensors(design: Design) -> list[str]:
    """Noise and converter of the sensors, as their maker states them."""
    bench = design.bench
    noise = ", ".join(f"{name} = {bench.noise[name]:.3g}" for name in NOISE)
    lines = [f"noise = {{ {noise} }}"]
    if bench.bits:
        ranges = ", ".join(f"{name} = {bench.range_of(name):g}" for name in NOISE)
        bits = ", ".join(f"{name} = {bits}" for name, bits in bench.bits.items())
        lines += [f"range = {{ {ranges} }}", f"bits = {{ {bits} }}"]
    return lines


SETTLING = 0.35
"""Of a rig before its recording, unless this starts from rest [s]."""


def settled(rng, seconds):
    """Turn evenly throughout."""
    return np.ones_like


def _rest(rng, seconds):
    ramp = rng.uniform(0.005, 0.06)
    return lambda t: np.minimum(t / ramp, 1.0)


def _run_up(rng, seconds):
    low, ramp = rng.uniform(0.3, 0.7), rng.uniform(0.2, 0.5) * seconds

    def course(t):
        x = np.minimum(t / ramp, 1.0)
        return low + (1.0 - low) * x * x * (3.0 - 2.0 * x)

    return course


def _swing(rng, seconds):
    depth, frequency = rng.uniform(0.15, 0.4), rng.uniform(4.0, 15.0)
    decay = rng.uniform(0.03, 0.12) * seconds
    return lambda t: 1.0 + depth * np.exp(-t / decay) * np.sin(2.0 * np.pi * frequency * t)


STARTS: dict[str, Callable] = {
    "settled": settled, "rest": _rest, "run_up": _run_up, "swing": _swing,
}  # fmt: skip
"""By name: a drive that is switched on, one that is run up, one whose controller swings in."""
