"""Whatever is damaged is read, or refused in one line, soon and in little memory.

`CALLS` are commands and readers, each with the valid file that is damaged for it. An input is told
by the call and a number. ``corpus.jsonl`` holds what ever failed, one JSON object a line: what
happened, the call, the file's content, and its stem where that is what failed.
"""

from __future__ import annotations

import base64
import faulthandler
import io
import json
import os
import re
import shutil
import signal
import sys
import zlib
from contextlib import redirect_stderr, redirect_stdout
from importlib import resources
from pathlib import Path

import numpy as np
import pytest
import soundfile

from models.errors import BushingNoiseError
from noise.base.tables import write_table
from noise.cli import main
from tests.helpers.logger_files import WRITERS, Wave, uff
from tests.helpers.made_reviews import row
from tests.helpers.small_rigs import RIG_FILE

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="memory is counted as Linux does")

LONGEST = 20.0  # s of computing, of an input; ten times as long by the clock of a busy machine
MOST_MEMORY = 700_000_000  # byte that an input may take beside what its process already holds
RATE, N = 48_000, 2400

TRIED: set[str] = set()

CORPUS = [
    json.loads(line)
    for line in Path(__file__).with_name("corpus.jsonl").read_text(encoding="utf-8").splitlines()
]


# --- valid files --------------------------------------------------------------------------------

EFFECTS = """\
from sim.effects.effect import Effect, Stage
from sim.parameters import Parameter


def sensors(signals, rate, form, values, rng):
    return signals | {"torque": signals["torque"] + values["offset"]}


OFFSET = {"offset": Parameter(0.5, "Nm", -50.0, 50.0, "of the torque cell")}
EFFECT = Effect("zero_offset", Stage.MEASUREMENT, ("constant",), OFFSET, "offset", sensors=sensors)
"""
RESPONSES = '[[measured_response]]\nsupport_stiffness_Nm_rad = 2214.0\ntorque_to_pressure = "given'
SIDECAR = {
    "channels": [{"name": "pressure", "unit": "Pa", "position_m": [0.1, 0.0, 0.5]}],
    "conditions": {"speed_rad_s": 5.0, "interference_mm": 0.279, "material": "fluorocarbon"},
    "calibrated": True,
}
TEXTS = {
    "sidecar.json": json.dumps(SIDECAR),
    "rig.toml": RIG_FILE,
    "rig_csv.toml": f'{RIG_FILE}\n{RESPONSES}.csv"\n',
    "rig_npz.toml": f'{RIG_FILE}\n{RESPONSES}.npz"\n',
    "response.csv": "frequency_hz,real,imag\n"
    + "".join(f"{100 + 150 * k},{0.01 * k:.3f},{-0.002 * k:.3f}\n" for k in range(40)),
    "log.csv": "time_s,speed_rad_s\n" + "".join(f"{0.01 * k:.2f},{5 + k}\n" for k in range(20)),
    "effects.py": EFFECTS,
}


@pytest.fixture(scope="module")
def valid(tmp_path_factory):
    """Folder of one small valid file of each kind that a command reads."""
    folder = tmp_path_factory.mktemp("valid")
    rng = np.random.default_rng(7)
    for name, subtype in {
        "float.wav": "FLOAT", "pcm.flac": "PCM_16", "pcm.aiff": "PCM_24",
        "vorbis.ogg": "VORBIS", "layer.mp3": "MPEG_LAYER_III",
    }.items():  # fmt: skip
        soundfile.write(folder / name, 0.1 * rng.normal(size=(N, 1)), RATE, subtype=subtype)
    waves = [Wave("mic", "Pa", rng.normal(size=300)), Wave("torque", "Nm", rng.normal(size=300))]
    for ending, write in WRITERS.items():
        write(folder / f"logger{ending}", waves, {"speed_rad_s": 5.0, "material": "PDMS"})
    uff(folder / "logger.uff", (waves[0].samples, "Pa"))
    for name, text in TEXTS.items():
        (folder / name).write_text(text, encoding="utf-8")
    rows = [row("given.wav", "creak", 0.0, 0.02), row("given.wav", "none", 0.02, 0.05)]
    for ending in (".csv", ".jsonl", ".parquet"):
        write_table(folder / f"labels{ending}", list(rows[0]), rows)
    t = np.arange(1000) / 20e3
    hit = np.column_stack([t, 100.0 * np.exp(-(((t - 2e-3) / 2e-4) ** 2)), np.sin(900.0 * t)])
    np.save(folder / "hit.npy", hit)
    np.savetxt(folder / "hit.csv", hit[:300], "%.6g", ",", header="time,force,response")
    with resources.as_file(resources.files("noise.classifier") / "data/classifier.npz") as path:
        shutil.copy(path, folder / "classifier.npz")
    f = 100.0 + 150.0 * np.arange(40)
    np.savez(
        folder / "response.npz", frequency_hz=f, response=0.1 + 0.01j * f,
        coherence=np.full(40, 0.9), input_unit="N m", output_unit="Pa",
    )  # fmt: skip
    return folder


# --- what is done with them ---------------------------------------------------------------------

BRIEF = "--speed 5 --seconds 0.01 --out out.wav"
REVIEW = "review . --out out.html"
RUN, SOUND, RIG = {"run.wav": "float.wav"}, {"given.wav": "float.wav"}, {"rig.toml": "rig.toml"}

CALLS = {
    **{
        name: ("float.wav", "given.wav", call, RUN | RIG)
        for name, call in {
            "features": "features GIVEN",
            "label": "label GIVEN --out out.csv",
            "render": "render GIVEN --out out.wav",
            "review": REVIEW,
            "identify": "identify GIVEN",
            "frf": "frf GIVEN --out out.npz",
            "calibrator": "features run.wav --calibrator GIVEN --level 94",
            "diagnose": "diagnose GIVEN --rig rig.toml --quick --out out",
        }.items()
    },
    **{
        name: (name, f"given{Path(name).suffix}", "features GIVEN", {})
        for name in (
            *("pcm.flac", "pcm.aiff", "vorbis.ogg", "layer.mp3"),
            *("logger.h5", "logger.mf4", "logger.tdms", "logger.uff"),
        )
    },
    **{
        f"{what} of labels{ending}": (f"labels{ending}", f"given{ending}", call, SOUND)
        for ending in (".csv", ".jsonl", ".parquet")
        for what, call in {"map": "label GIVEN --map out.png", "review": REVIEW}.items()
    },
    "sidecar": ("sidecar.json", "given.json", "features given.wav", SOUND),
    "rig": ("rig.toml", "given.toml", f"simulate --rig GIVEN {BRIEF}", {}),
    "rig, diagnosed": ("rig.toml", "given.toml", "diagnose run.wav --rig GIVEN --out out", RUN),
    **{
        f"response.{kind}": (
            f"response.{kind}", f"given.{kind}", f"simulate --rig rig.toml {BRIEF}",
            {"rig.toml": f"rig_{kind}.toml"},
        )
        for kind in ("csv", "npz")
    },
    "log": ("log.csv", "given.csv", "simulate --speed GIVEN --seconds 0.01 --out out.wav", {}),
    "effects": (
        "effects.py", "given.py", f"simulate --effects GIVEN --effect zero_offset {BRIEF}", {},
    ),
    "hit.npy": ("hit.npy", "given.npy", "frf GIVEN --out out.npz", {}),
    "hit.csv": ("hit.csv", "given.csv", "frf GIVEN --out out.npz", {}),
    "classifier": ("classifier.npz", "given.npz", "label run.wav --classifier GIVEN", RUN),
}  # fmt: skip
"""Name -> valid file, what it is called, command, further valid files beside it."""

LONG = {"identify", "diagnose", "rig, diagnosed", "review of labels.jsonl"}
"""Calls that take seconds, or what another takes as well: damaged in the slow tests alone."""


# --- damage -------------------------------------------------------------------------------------

COUNTS = (0, 1, 2, 3, 24, 255, 4096, 65535, 10**8, 2**31 - 1, 2**31, 2**32 - 1, 2**62, 2**64 - 1)
WORDS = (
    "nan", "inf", "-1", "0", "1e308", "1e-308", "1e999", "9" * 400, "", '"', "true", "[]", "{}",
    "null", "'x'", "\\", ",", "\t", "\x00", "\x1b[31m", "\ufeff", "\u202e", "=1+1", "/dev/zero",
    "../../etc/passwd", "1979-05-27", "x" * 20_000, "fixed", "1..2..3", "0..1e9", "[" * 20_000,
    '{"a":' * 20_000, "a." * 20_000,
)  # fmt: skip
NAMES = (
    "=cmd", "-out", "\x1b]0;x\x07", "a\nb", "\udcff\udcfe", "a,b", 'q"', " ", "\u202egpj",
    "x" * 200, "%s%n{0}", "~", "#", "--help", "nul\u2028line",
)  # fmt: skip


def damaged(content, rng):
    """Change bytes, words or lines of a file, half the time in its first 400 bytes."""
    for _ in range(int(rng.integers(1, 4))):
        n = max(1, len(content))
        at = int(rng.integers(min(n, 400) if rng.random() < 0.5 else n))
        piece = content[at : at + int(rng.integers(1, 400))]
        width = int(rng.choice([1, 2, 4, 8]))
        count = COUNTS[rng.integers(len(COUNTS))] % 256**width
        words = list(re.finditer(rb"[\w.+-]+", content[at:]))[:1]
        word = WORDS[rng.integers(len(WORDS))].encode()
        end = at + len(piece)
        ways = [
            content[:at] + rng.bytes(width) + content[at + width :],
            content[:at] + count.to_bytes(width, "little") + content[at + width :],
            content[:at] + count.to_bytes(width, "big") + content[at + width :],
            content[:at],
            content[:at] + content[end:],
            content[:at] + rng.bytes(100) + content[at:],
            content[:at] + piece * int(rng.choice([2, 50, 500])) + content[end:],
            content[:at] + bytes(len(piece)) + content[end:],
            *[content[: at + w.start()] + word + content[at + w.end() :] for w in words] * 4,
            content[:16] + rng.bytes(500),
            content.decode("utf-8", "replace").encode("utf-16"),
        ]  # fmt: skip
        content = ways[rng.integers(len(ways))]
    return content


# --- the verdict --------------------------------------------------------------------------------


def faults(name, content, valid, folder, stem=None, longest=LONGEST):
    """Give a file to its call in a folder of its own, and find fault with what a user would see."""
    _, called, call, beside = CALLS[name]
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    os.chdir(folder)
    path = Path(called) if stem is None else Path(called).with_name(stem + Path(called).suffix)
    for own, file in beside.items():
        shutil.copy(valid / file, own)
    path.write_bytes(content)
    said, found = io.StringIO(), []
    Path("/proc/self/clear_refs").write_text("5")  # the highest memory counts from here
    before = _highest_memory()
    faulthandler.register(signal.SIGPROF, chain=True)  # which then ends the process
    signal.setitimer(signal.ITIMER_PROF, longest)
    faulthandler.dump_traceback_later(10 * longest, exit=True)
    try:
        with redirect_stdout(io.StringIO()), redirect_stderr(said):
            code = _run(call, path)
        found += [f"exit code {code}"] if code not in (0, 1, 2) else []
    except BaseException as error:
        found.append(f"traceback: {error!r:.200}")
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        faulthandler.cancel_dump_traceback_later()
    text = said.getvalue()
    if re.search(r"[\x00-\x09\x0b-\x1f\x7f-\x9f\u2028\u202e]", text):
        found.append("controls the terminal")
    more = _highest_memory() - before
    if more > MOST_MEMORY:
        found.append(f"memory of {more / 1e6:.0f} MB")
    return [f"{one} ({text[-300:]!r})" for one in found]


def _highest_memory():
    """Return the highest memory that this process has had, in byte."""
    return 1024 * int(re.search(r"VmHWM:\s*(\d+)", Path("/proc/self/status").read_text())[1])


def _run(call, path):
    return main([part.replace("GIVEN", str(path)) for part in call.split()])


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Give a place to work in, and refuse messages of several lines."""
    init = BushingNoiseError.__init__

    def checked(error, *given):
        init(error, *given)
        own = next((str(one) for one in tmp_path.glob("in/*.*") if "\n" in one.name), "\0")
        assert "\n" not in str(error).replace(Path(own).name, "")

    monkeypatch.setattr(BushingNoiseError, "__init__", checked)
    monkeypatch.setattr("noise.recordings.formats.isolated._TIME_LIMIT", 3.0)
    monkeypatch.chdir(tmp_path)
    return tmp_path / "in"


def check_valid(name, valid, folder):
    """See that what is damaged was valid; what it needs is loaded and compiled by then."""
    content = (valid / CALLS[name][0]).read_bytes()
    if name not in TRIED:
        assert not faults(name, content, valid, folder, longest=600.0)
        TRIED.add(name)
    return content


def check_damaged(name, numbers, valid, folder):
    content = check_valid(name, valid, folder)
    for number in numbers:
        rng = np.random.default_rng([number, zlib.crc32(name.encode())])
        named = "GIVEN" in str(CALLS[name][2]) and rng.random() < 0.08
        stem = str(rng.choice(NAMES)) if named else None
        assert not faults(name, damaged(content, rng), valid, folder, stem), f"number {number}"


@pytest.mark.parametrize("name", sorted(CALLS.keys() - LONG))
def test_a_damaged_file_gives_one_line(name, valid, folder):
    check_damaged(name, range(2), valid, folder)


@pytest.mark.slow
@pytest.mark.parametrize("name", CALLS)
def test_a_damaged_file_gives_one_line_for_long(name, valid, folder):
    check_damaged(name, range(2000), valid, folder)


@pytest.mark.parametrize("i", range(len(CORPUS)))
def test_what_ever_failed_gives_one_line(i, valid, folder):
    entry = CORPUS[i]
    content = zlib.decompress(base64.b85decode(entry["content"]))
    check_valid(entry["call"], valid, folder)
    found = faults(entry["call"], content, valid, folder, entry.get("stem"))
    assert not found, entry["about"]
