"""Calls that cannot be used, by command: one line says why, exit code 2, and nothing is written."""

import os
import re
import shlex
import subprocess
import sys

import numpy as np
import pytest
import soundfile

from models.condition import Condition
from noise.cli import main
from tests.helpers.files import pressure_file
from tests.helpers.small_rigs import RIG_FILE

FILES = {
    "file.txt": "notes",
    "misspelt.toml": 'base = "fluorocarbon"\ndesing = 1\n',
    "lawless.toml": re.sub("(?m)^(effects|friction).*", "", RIG_FILE),
    "ours.toml": 'base = "fluorocarbon"\n',
    "letters.csv": "0,1\n1,x\n",
    "hours.csv": "hour,speed\n0,1\n1,2\n",
    "standing.csv": "0,1\n0,2\n",
    "nan.csv": "0,1\n1,nan\n",
    "nothing.csv": "",
    "labels.csv": "file,label\nruns/a.wav,creak\n",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("refused")
    hiss = np.random.default_rng(0).normal(size=(1, 4800))
    for name in ("a", "b"):
        pressure_file(folder / "runs" / name, hiss, 48e3, Condition(speed=5.0))
    for name, text in FILES.items():
        (folder / name).write_text(text, encoding="utf-8")
    (folder / "damaged.csv").write_bytes(b"\xff\xfe\x00")
    (folder / "empty").mkdir()
    soundfile.write(folder / "phone.wav", 0.5 * np.sin(np.arange(4800.0)), 48_000)
    soundfile.write(folder / "tone.wav", 0.05 * np.sin(np.arange(96_000) / 48 * 2 * np.pi), 48_000)
    np.save(folder / "rows.npy", np.stack([np.arange(1000) / 1e3, np.eye(1000)[9], hiss[0, :1000]]))
    return folder


SOURCE = [
    ("nowhere", "nowhere: there is no such file"),
    ("empty", "empty: there are no recordings"),
    ("''", "is '', expected a path"),
    ("runs --full-scale 0", "--full-scale"),
    ("phone.wav --calibrator tone.wav", "--calibrator needs --level"),
    ("phone.wav --level 94", "--level a --calibrator"),
    ("phone.wav --calibrator phone.wav --level 94", "--calibrator phone.wav: is no calib"),
    ("phone.wav --calibrator tune.wav --level 94", "--calibrator tune.wav: there is no such"),
    ("phone.wav --calibrator tone.wav --level ninety", "--level"),
    ("phone.wav --calibrator tone.wav --level 94 --full-scale 20", "not allowed with"),
]
BATCH = [
    *SOURCE,
    ("runs --out t.txt", "t.txt: tables end in .csv, .xlsx, .jsonl or .parquet"),
    ("runs --out runs/a.wav/t.csv", "is a file, not a folder"),
    (f"runs --workers {'9' * 5000}", "expected a whole number from 1 to 1024"),
    ("", "PATH"),
]
SIMULATE = [
    *((f"{turning} {option} {value}", option)
      for turning, option in (("", "--speed"), ("--speed 1", "--interference"),
                              ("--speed 1", "--support-stiffness"), ("--speed 1", "--temperature"),
                              ("--speed 1", "--seconds"), ("--speed 1", "--rate"))
      for value in ("nan", "-inf", "five", "''", "1..x")),
    ("", "exactly one of --speed and --oscillate is needed"),
    ("--speed 1 --oscillate 15,2", "--oscillate can be given, not both"),
    ("--oscillate 15", "--oscillate is '15', expected degrees and Hz"),
    ("--speed 1 --support-stiffness 1e300", "belongs to no beam; possible is 0.001 to 1e+12"),
    ("--speed 1 --temperature -300", "--temperature"),
    ("--speed 1 --seconds 121", "at most 120"),
    ("--speed 1 --material teflon", "--material"),
    ("--speed 1 --effect wobble", "--effect"),
    ("--speed 1 --effect slip_pulse:loudness=2", "--effect"),
    ("--speed 1 --rig no-such-rig.toml", "--rig"),
    ("--speed 1 --rig misspelt.toml", "unknown key 'desing'; did you mean 'design'?"),
    ("--speed 1 --rig lawless.toml", 'write base = "fluorocarbon"'),
    ("--speed 1 --rig ours.toml --material PDMS", "--material PDMS contradicts --rig"),
    ("--speed 1 --change damping", "--change"),
    ("--speed 1 --change dampin=x2", "dampin"),
    ("--speed 1 --change damping=x0", "damping"),
    ("--speed 1 --change damping=x2 --change damping=x3", "one name is given twice"),
    ("--speed 1 --change wall_mm=1e-300", "sleeve: wall_mm = 1e-300 must be a number from"),
    ("--speed 1 --seed -1", "--seed"),
    ("--speed 1 --out file.txt/run07", "--out"),
    ("--speed 1 --plot run.gif", "--plot run.gif: a picture ends in"),
    ("--speed 1 --sound-power power.ods", "tables end in .csv, .xlsx, .jsonl or .parquet"),
    ("--speed 1 --sound-power p.csv --seconds 0.1", "--seconds 0.1 is too short"),
    ("--rig suspension --oscillate 6,2 --plot x.png", "--plot is for the rig only"),
    ("--sped 5", "--sped"),
    ("--speed letters.csv", "--speed letters.csv: column 2 is 'x' in line 2, expected a number"),
    ("--speed hours.csv", "has the columns hour, speed, expected time_s and speed_rad_s"),
    ("--speed standing.csv", "time does not rise"),
    ("--speed nan.csv", "no finite number"),
    ("--speed nothing.csv", "holds no rows of numbers"),
    ("--speed damaged.csv", "is damaged"),
]  # fmt: skip
RENDER = [
    *((f"{call} --out s", said) for call, said in SOURCE if said != "is '', expected a path"),
    ("runs --out s.wav", "2 sounds are no single file"),
    ("runs --out file.txt", "is a file; name a folder"),
    ("runs --out runs", "would overwrite"),
    ("runs/a.wav --out runs/a", "would overwrite"),
    ("runs/a.wav --ab --out s.wav", "give a second one"),
    ("runs --ab --match-loudness --out s.wav", "--match-loudness"),
    ("runs/a.wav --pascal-per-full-scale 1e300 --out s.wav", "at most 1e+09"),
    ("runs/a.wav --pascal-per-full-scale 0.1 --out s.wav", "would clip"),
    ("runs/a.wav --band 1e-300..1 --out s.wav", "expected a band that begins at 1 Hz"),
    ("runs/a.wav --band 100..100.0001 --out s.wav", "at least 1% wide"),
    ("phone.wav --pascal-per-full-scale 2 --out s.wav", "--full-scale"),
    ("runs phone.wav --out s", "is not, so one gain cannot"),
    ("'' --out s.wav", "INPUT is empty"),
    ("--interference 0.3 --out s.wav", "--speed and --oscillate"),
    ("ours.toml --rig ours.toml --speed 5 --out s", "are both rigs"),
    ("--out s.wav", "a recording, or a condition"),
    ("runs/a.wav --speed 5 --out s.wav", "--speed describes"),
    ("--speed 5 --full-scale 2 --out s.wav", "--full-scale"),
]
CALLS = {
    "simulate": SIMULATE,
    "render": RENDER,
    "features": BATCH,
    "label": [
        *BATCH,
        ("runs --map m.gif", "a picture ends in"),
        ("runs --out m.csv --map m.png", "give one of them another name"),
        ("runs --classifier none.npz", "none.npz"),
        ("labels.csv", "is a table; draw it with --map"),
    ],
    "screen": [
        ("misspelt.toml", "unknown key 'desing'; did you mean 'design'?"),
        ("lawless.toml", 'write base = "fluorocarbon"'),
        ("teflon", "neither a file nor a material"),
        ("PDMS nowhere.toml", "there is no such file"),
        ("PDMS teflon", "neither a file nor a material"),
        ("PDMS --workers none", "--workers is 'none', expected a whole number from 1 to 1024"),
        ("PDMS --speed fast", "--speed is 'fast'"),
        ("PDMS --speed 0,1", "values must be above 0"),
        ("PDMS --speed 9..1", "a range rises"),
        ("PDMS --interference 11", "--interference is 11 mm; it must be at most 10"),
        ("PDMS --temperature -300", "above -273.15"),
        ("PDMS --support-stiffness soft", "--support-stiffness is 'soft'"),
        ("PDMS --oscillate 15", "--oscillate is '15', expected degrees and Hz"),
        ("PDMS --environment mud", "'mud' is unknown"),
        ("PDMS --out file.txt", "is a file; name a folder"),
    ],
    "frf": [
        ("nowhere.npy", "nowhere.npy: there is no such file"),
        ("rows.npy --out beam.mat", "responses end in"),
        ("rows.npy --modes modes.ods", "tables end in"),
        ("rows.npy --arm 0", "--arm is '0', expected a number above 0"),
        ("rows.npy --band 5..2 --modes m.csv", "--band is '5..2'"),
        ("rows.npy --band 2..5", "--band needs --modes"),
    ],
    "diagnose": [
        ("empty --rig ours.toml --out s", "empty"),
        ("runs --rig misspelt.toml --out s", "unknown key 'desing'; did you mean 'design'?"),
        ("runs --out s", "--rig"),
    ],
    "identify": [
        ("empty --out s", "empty"),
        ("runs --rig misspelt.toml --out s", "unknown key 'desing'; did you mean 'design'?"),
        ("runs --out file.txt", "file.txt"),
    ],
    "review": [*((f"{call} --out s.html", said) for call, said in SOURCE)],
    "train": [
        ("", "--out"),
        ("--out mine.pkl", "--out mine.pkl: a classifier is a file that ends in .npz"),
        ("--out file.txt/mine.npz", "--out"),
        ("--out a.npz --add nowhere", "--add nowhere: there is no such folder"),
    ],
    "demo": [("--out file.txt", "is a file; name a folder")],
    "open": [("--port many", "--port"), ("nowhere.wav --no-browser", "nowhere.wav")],
    "thesis": [("--out t.ods", "this table ends in")],
    "imitate": [("--speed 5", "simulate")],
}


@pytest.mark.parametrize("command", CALLS)
def test_a_call_that_cannot_be_used_is_refused_in_one_line(folder, command, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    before = sorted(folder.rglob("*"))
    for call, reason in CALLS[command]:
        code = main([command, *shlex.split(call)])
        out, err = capsys.readouterr()
        assert (code, out) == (2, ""), f"{command} {call}: {err}"
        (line,) = (line for line in err.splitlines() if "error: " in line)
        assert reason in line, f"{command} {call}"
        assert "Traceback" not in err
    assert sorted(folder.rglob("*")) == before


@pytest.mark.parametrize(
    "call",
    ["screen no.toml", "screen PDMS --speed 5..x", "simulate --speed 5 --rig no.toml",
     "diagnose . --rig no.toml"],
)  # fmt: skip
def test_what_is_refused_is_refused_before_the_simulator_is_loaded(call, tmp_path):
    heavy = ("scipy", "sklearn", "librosa", "matplotlib", "numba", "soundfile")
    program = (
        "import sys; from noise.cli import main\n"
        f"print(main({call.split()}), [name for name in {heavy} if name in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path, check=False
    )
    assert done.stdout == "2 []\n", done.stderr


@pytest.mark.skipif(os.name == "nt", reason="has no pipes among its files")
def test_a_pipe_is_refused_by_every_command_and_not_waited_for(folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    pipes = [f"pipe{ending}" for ending in (".wav", ".npz", ".toml", ".npy", ".csv", ".json")]
    for name in pipes:
        os.mkfifo(name)
    for call in (
        "label pipe.wav", "features pipe.wav", "render pipe.wav --out s.wav",
        "label runs/a.wav --classifier pipe.npz",
        "simulate --rig pipe.toml --speed 5 --out s.wav", "screen pipe.toml", "frf pipe.npy",
        "review pipe.csv --out s", "review pipe.json --out s", "label pipe.csv --map s.png",
        "diagnose runs/a.wav --rig pipe.toml", "open pipe.wav --no-browser",
    ):  # fmt: skip
        assert main(call.split()) in (1, 2), call
        assert "is a pipe, not a file" in capsys.readouterr().err, call
    for name in pipes:
        (folder / name).unlink()
