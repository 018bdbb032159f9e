"""Outputs of the whole program, made once and compared with those of a later state.

    python -m tests.golden make FOLDER
    python -m tests.golden compare FOLDER

`make` calls the commands of `CALLS` in FOLDER. `compare` calls them again in a temporary folder and
lists each file that differs: samples of recordings exactly, numbers of tables and JSON within one
part in a million. Labels and features of real recordings are included where
``BUSHING_NOISE_REAL_DATA`` names their folder. FOLDER lies outside the repository.
"""

from __future__ import annotations

import contextlib
import csv
import io
import itertools
import json
import math
import os
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np
import soundfile as sf

from noise.cli import main

RELATIVE = 1e-6  # numbers of tables are rounded to fewer digits

CONDITIONS = (
    "--speed 1 --interference 0.381",
    "--speed 5",
    "--speed -5 --seed 3",
    "--speed 10 --support-stiffness 3745",
    "--speed 5 --support-stiffness fixed",
    "--speed 0..12 --seconds 2 --support-stiffness fixed",
    "--oscillate 15,2 --interference 0.381",
    "--speed 5 --material PDMS --interference 0.381",
    "--speed 10 --material natural-rubber --interference 0.127",
    "--speed 5 --material natural-rubber-film",
    "--speed 5 --material fluorocarbon-thesis --effect velocity_weakening:share=0.1",
    "--speed 5 --effect mains_hum --effect background_noise --effect mount_resonance",
    "--speed 5 --effect speed_fluctuation --effect shaft_compliance",
    "--speed 2 --effect partial_slip --effect frictional_heating",
    "--speed 2 --effect static_ageing --effect transfer_film --effect viscoelastic_stiffness",
    "--speed 5 --effect clipping --effect gain_error --effect channel_delay",
    "--speed 5 --effect room_reflections --effect beam_modes --effect plate_modes",
    "--speed 5 --effect amplitude_softening --effect critical_torque_scatter",
    "--speed 5 --temperature 80 --rate 48000",
    "--rig suspension --oscillate 6,1",
)
BENCH = """base = "fluorocarbon-thesis"
effects = ["slip_pulse:amplitude=400"]
[change]
elastomer_stiffness = "+15 %"
critical_torque = "+10 %"
damping = "x1.3"
"""
KNOWN = """name = "our bench"
elastomer_inertia_kgm2 = 1.538e-5
clamp_inertia_kgm2 = 8.333e-4
"""
BENCH_SPEEDS = (1, 1.5, 2, 2.5, 2.5, 3)


def calls() -> list[str]:
    """Return the command lines, in their order; later ones read what earlier ones write."""
    lines = [f"simulate {c} --out runs/{k:02d}" for k, c in enumerate(CONDITIONS)]
    lines += [
        "demo --out demo",
        "label runs --out runs-labels.csv",
        "features runs --out runs-features.csv",
        "render runs/00.wav runs/01.wav --out set",
        "render runs/00.wav runs/01.wav --ab --out ab.wav",
        "frf demo/hits --arm 0.05 --out frf.npz --modes modes.csv",
        "screen fluorocarbon --speed 0.5..13/12 --out screen",
        "screen PDMS fluorocarbon --oscillate 15,0.5..4 --no-tolerances --out swung",
        "thesis --out thesis.csv",
    ]
    lines += [
        f"simulate --rig bench.toml --speed {speed} --seed {k} --out bench/{k}"
        for k, speed in enumerate(BENCH_SPEEDS, start=1)
    ]
    lines += [
        "identify bench --rig known.toml --out mine",
        "diagnose bench --rig bench.toml --quick --out same",
        "diagnose bench --rig mine/rig.toml --quick --out diagnosis",
    ]
    real = os.environ.get("BUSHING_NOISE_REAL_DATA")
    if real:
        lines += [
            f"label {real}/audio {real}/labelled --out real-labels.csv",
            f"features {real}/audio {real}/labelled/creak --out real-features.csv",
        ]
    return lines


def make(folder: Path) -> None:
    """Call all commands with `folder` as the current folder."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "bench.toml").write_text(BENCH)
    (folder / "known.toml").write_text(KNOWN)
    with contextlib.chdir(folder):
        for line in calls():
            with contextlib.redirect_stdout(io.StringIO()):
                code = main(line.split())
            if code not in (0, 1):
                sys.stderr.write(f"golden: exit code {code}: {line}\n")


def differences(first: Path, second: Path) -> list[str]:
    """Compare all recordings, tables, arrays and JSON files of two folders."""
    names = sorted(
        {
            str(path.relative_to(root))
            for root in (first, second)
            for path in root.rglob("*")
            if path.suffix in {".wav", ".csv", ".json", ".npz", ".toml"}
        }
    )
    found = []
    for name in names:
        pair = first / name, second / name
        missing = [str(path) for path in pair if not path.exists()]
        reason = f"missing: {missing[0]}" if missing else _difference(*pair)
        if reason:
            found.append(f"{name}: {reason}")
    return found


def _difference(first: Path, second: Path) -> str:
    if first.suffix == ".wav":
        x, y = sf.read(first)[0], sf.read(second)[0]
        if x.shape != y.shape:
            return f"shape {x.shape}, was {y.shape}"
        return "" if np.array_equal(x, y) else f"samples differ by up to {np.abs(x - y).max():.3g}"
    if first.suffix == ".npz":
        with np.load(first) as a, np.load(second) as b:
            return _compare({k: a[k].tolist() for k in a}, {k: b[k].tolist() for k in b})
    return _compare(_read(first), _read(second))


def _read(path: Path) -> object:
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".csv":
        return {k: dict(enumerate(row)) for k, row in enumerate(csv.reader(io.StringIO(text)))}
    if path.suffix == ".json":
        return json.loads(text)
    return dict(enumerate(line for line in text.splitlines() if not line.startswith("#")))


def _compare(new: object, old: object, place: str = "") -> str:
    """Return the first difference of two nested values, or nothing."""
    if isinstance(new, dict) and isinstance(old, dict):
        if place.endswith("seconds"):
            return ""
        if new.keys() != old.keys():
            return f"{place} keys {sorted(map(str, new.keys() ^ old.keys()))[:6]} in one only"
        pairs = ((f"{place}/{key}", new[key], old[key]) for key in new)
    elif isinstance(new, list) and isinstance(old, list):
        if len(new) != len(old):
            return f"{place} has {len(new)} entries, had {len(old)}"
        pairs = ((f"{place}/{k}", a, b) for k, (a, b) in enumerate(zip(new, old, strict=True)))
    else:
        return "" if place.endswith("/seconds") or _same(new, old) else f"{place}: {new}, was {old}"
    return next(filter(None, itertools.starmap(_pair, pairs)), "")


def _pair(place: str, new: object, old: object) -> str:
    return _compare(new, old, place)


def _same(new: object, old: object) -> bool:
    if new == old:
        return True
    if isinstance(new, complex) and isinstance(old, complex):
        return abs(new - old) <= RELATIVE * abs(old)
    try:
        if math.isnan(float(new)) and math.isnan(float(old)):  # type: ignore[arg-type]
            return True
        return math.isclose(float(new), float(old), rel_tol=RELATIVE)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return False


def run(arguments: list[str]) -> int:
    """Make or compare; return how many files differ, as an exit code."""
    action, folder = arguments[0], Path(arguments[1]).resolve()
    if action == "make":
        make(folder)
        return 0
    with tempfile.TemporaryDirectory() as temporary:
        make(Path(temporary))
        found = differences(Path(temporary), folder)
        keep = os.environ.get("GOLDEN_KEEP")
        if keep:
            shutil.copytree(temporary, keep, dirs_exist_ok=True)
    sys.stdout.write("\n".join([*found, f"{len(found)} files differ"]) + "\n")
    return min(len(found), 1)


if __name__ == "__main__":
    raise SystemExit(run(sys.argv[1:]))
