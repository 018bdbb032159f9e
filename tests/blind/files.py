"""Files of a case, the same bytes each time: float WAV without its usual time stamp, NPZ, TOML."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

import numpy as np

from .benches import NOISE
from .laws import LAWS

if TYPE_CHECKING:
    from pathlib import Path

    from .design import Design

__all__ = ["rig_text", "support_name", "write_npz", "write_wav"]


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
