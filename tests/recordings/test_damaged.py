"""Damaged recordings: a file cut anywhere is refused, and so is what fuzzing ever found.

Damage of all sorts, on every reader and command, is in `tests/fuzz`.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import soundfile
from hypothesis import HealthCheck, given, settings, strategies as st

from models.errors import RecordingError
from noise.recordings import find_recordings, read_recording
from tests.helpers.logger_files import WRITERS, Wave, uff

ENDINGS = (*WRITERS, ".uff", ".wav", ".flac")


@pytest.fixture(scope="module")
def valid(tmp_path_factory):
    folder = tmp_path_factory.mktemp("valid")
    x, y = np.random.default_rng(7).normal(0, 0.1, (2, 300))
    for ending, write in WRITERS.items():
        waves = [Wave("mic", "Pa", x), Wave("torque", "", y)]
        write(folder / f"valid{ending}", waves, {"speed_rad_s": 5.0, "material": "PDMS"})
    uff(folder / "valid.uff", (x, "Pa"))
    for ending in (".wav", ".flac"):
        soundfile.write(folder / f"valid{ending}", x, 51200, subtype="PCM_16")
    assert {read_recording(path).rate for path in folder.iterdir()} == {51200.0}
    return {ending: (folder / f"valid{ending}").read_bytes() for ending in ENDINGS}


def refusal(folder: Path, ending: str, content: bytes) -> str:
    path = folder / f"run{ending}"
    path.write_bytes(content)
    with pytest.raises(RecordingError) as refused:
        read_recording(path)
    message = str(refused.value)
    assert message.startswith(str(path))
    assert "\n" not in message
    return message


@pytest.mark.parametrize("ending", ENDINGS)
@settings(max_examples=30, suppress_health_check=list(HealthCheck))
@given(share=st.floats(0, 1, exclude_max=True))
def test_a_file_cut_anywhere_is_refused(valid, tmp_path_factory, ending, share):
    # In text, all samples are there once the mark of the end has begun.
    content = valid[ending]
    whole = content.rindex(b"    -1") if ending == ".uff" else len(content)
    refusal(tmp_path_factory.mktemp("cut"), ending, content[: int(share * whole)])


def at(content: bytearray, place: int, width: int, value: int) -> bytes:
    content[place : place + width] = value.to_bytes(width, "little")
    return bytes(content)


def text_of_4_gb(c):
    place = c.index(b"unit\0")
    return at(c, c.index((2).to_bytes(4, "little"), place + 32), 4, 2**32 - 1)


def heap_without_end(c):
    heap = c.index(b"GCOL")
    at(c, heap + 24, 8, 0)  # length of the first text ...
    return at(c, heap + 16, 2, 0)  # ... which is now free space that goes nowhere


def group_that_follows_itself(c):
    group = c.index(b"##DG")
    return at(c, group + 24, 8, group)


def text_beyond_the_end(c):
    return at(c, c.index(b"##CN") + 24 + 16, 8, 1 << 40)  # third link of a channel


def channel_outside_its_record(c):
    channel = c.index(b"##CN")
    links = int.from_bytes(c[channel + 16 : channel + 24], "little")
    return at(c, channel + 24 + 8 * links + 4, 4, 10**6)


FOUND = {
    "text of 4 GB": (".h5", text_of_4_gb, "memory"),
    "heap without an end": (".h5", heap_without_end, "(reading it took longer than 2 s)"),
    "circle of groups": (".mf4", group_that_follows_itself, "(reading it took longer than 2 s)"),
    "text beyond the end": (".mf4", text_beyond_the_end, "exceeds the file size"),
    "channel outside": (".mf4", channel_outside_its_record, "of a record of"),
    "unknown version": (".tdms", lambda c: at(c, 8, 4, 9999), "version 9999, expected 4712"),
    "open segment": (".tdms", lambda c: at(c, 12, 8, 2**64 - 1), "its last segment goes on"),
}


@pytest.mark.parametrize(("ending", "damage", "reason"), FOUND.values(), ids=FOUND)
def test_what_fuzzing_found_is_refused(valid, tmp_path, monkeypatch, ending, damage, reason):
    if "longer" in reason:
        monkeypatch.setattr("noise.recordings.formats.isolated._PATIENCE", 2.0)
    assert reason in refusal(tmp_path, ending, damage(bytearray(valid[ending])))


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="counts memory in kB, as Linux does")
@pytest.mark.parametrize("ending", WRITERS)
def test_reading_takes_no_more_than_twice_the_file(tmp_path, ending):
    rng = np.random.default_rng(1)
    waves = [Wave(name, "Pa", rng.normal(size=4_000_000)) for name in ("a", "b", "c", "d")]
    path = WRITERS[ending](tmp_path / f"large{ending}", waves)
    small = WRITERS[ending](tmp_path / f"small{ending}", [Wave("a", "Pa", waves[0].samples[:99])])
    code = (
        "import resource, sys; from noise.recordings import read_recording;"
        "peak = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024;"
        "read_recording(sys.argv[1]); before = peak(); read_recording(sys.argv[2]);"
        "print(peak() - before)"
    )
    result = subprocess.run(
        [sys.executable, "-c", code, small, path], check=True, capture_output=True, text=True
    )
    assert int(result.stdout) < 2 * path.stat().st_size


DATA = os.environ.get("BUSHING_NOISE_REAL_DATA")


@pytest.mark.skipif(not DATA, reason="BUSHING_NOISE_REAL_DATA names no folder of real recordings")
def test_every_real_sound_is_read():
    found = find_recordings([Path(DATA) / "audio"])
    assert len(found) == 49
    for path, _ in found:
        run = read_recording(path)
        assert not run.calibrated
        assert run.samples.shape == (soundfile.info(path).channels, soundfile.info(path).frames)
