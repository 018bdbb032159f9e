"""Damaged files of every format are read or refused: no traceback, no hang, no memory beyond."""

from __future__ import annotations

import subprocess
import sys
import tracemalloc
from typing import TYPE_CHECKING

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from models.errors import RecordingError
from models.transfer_functions.uff import TIME_RESPONSE, UffFunction, write_uff_functions
from noise.recordings import read_recording
from tests.helpers.logger_files import WRITERS, Wave

if TYPE_CHECKING:
    from pathlib import Path

ENDINGS = (*WRITERS, ".uff")
MEMORY_OF_THE_LIBRARIES = 48 << 20  # bytes, for a file of any size: asammdf has a buffer of 32 MB
RATE = 51200.0
FAST = settings(max_examples=60, suppress_health_check=[HealthCheck.too_slow])
LONG = settings(FAST, max_examples=1000)


def valid_files(folder: Path) -> dict[str, bytes]:
    rng = np.random.default_rng(7)
    files = {}
    for ending, write in WRITERS.items():
        waves = [Wave("mic", "Pa", rng.normal(size=300)), Wave("torque", "", rng.normal(size=300))]
        path = folder / f"valid{ending}"
        files[ending] = write(path, waves, {"speed_rad_s": 5.0, "material": "PDMS"}).read_bytes()
    path = folder / "valid.uff"
    function = UffFunction(TIME_RESPONSE, np.arange(300) / RATE, rng.normal(size=300), "Pa")
    write_uff_functions(path, [function])
    return files | {".uff": path.read_bytes()}


@pytest.fixture(scope="module")
def valid(tmp_path_factory):
    folder = tmp_path_factory.mktemp("valid")
    files = valid_files(folder)
    for ending in ENDINGS:  # loads the libraries, which is not what is measured
        assert read_recording(folder / f"valid{ending}").rate == RATE
    return folder, files


def read_or_refuse(folder: Path, ending: str, content: bytes) -> bool:
    """Whether a file is read; if so, or if not, within the memory that its size allows."""
    path = folder / f"run{ending}"
    path.write_bytes(content)
    tracemalloc.start()
    try:
        run = read_recording(path)
    except RecordingError as error:
        assert str(error).startswith(str(path))  # noqa: PT017
        assert "\n" not in str(error)  # noqa: PT017
        return False
    else:
        assert np.isfinite(run.samples).all()
        return True
    finally:
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert peak < 2 * len(content) + MEMORY_OF_THE_LIBRARIES


def damaged(content: bytes, changes: list[tuple[float, int, int]]) -> bytes:
    """Overwrite numbers of 1, 2, 4 or 8 bytes at shares of the length."""
    wrong = bytearray(content)
    for share, width, value in changes:
        at = int(share * (len(content) - width))
        wrong[at : at + width] = (value % 256**width).to_bytes(width, "little")
    return bytes(wrong)


HOSTILE = st.one_of(
    st.sampled_from([0, 1, -1, 2**31 - 1, 2**31, 2**63 - 1, 2**62, 24, 64, 4096]),
    st.integers(0, 2**64 - 1),
)
CHANGES = st.lists(
    st.tuples(st.floats(0, 1), st.sampled_from([1, 2, 4, 8]), HOSTILE), min_size=1, max_size=4
)
SHARES = st.floats(0, 1, exclude_max=True)
RANDOM = st.tuples(st.sampled_from([0, 4, 16, 64]), st.binary(max_size=2000))


def check_random_bytes(valid, ending, head_and_rest):
    folder, files = valid
    head, rest = head_and_rest
    read_or_refuse(folder, ending, files[ending][:head] + rest)


def check_a_cut(valid, ending, share):
    folder, files = valid
    content = files[ending]
    # In text, all samples are there once the mark of the end has begun.
    whole = content.rindex(b"    -1") if ending == ".uff" else len(content)
    cut = content[: int(share * whole)]
    assert not read_or_refuse(folder, ending, cut)


def check_a_wrong_header(valid, ending, changes):
    folder, files = valid
    read_or_refuse(folder, ending, damaged(files[ending], changes))


@pytest.mark.parametrize("ending", ENDINGS)
@FAST
@given(content=RANDOM)
def test_random_bytes_are_read_or_refused(valid, ending, content):
    check_random_bytes(valid, ending, content)


@pytest.mark.parametrize("ending", ENDINGS)
@FAST
@given(share=SHARES)
def test_a_file_cut_anywhere_is_refused(valid, ending, share):
    check_a_cut(valid, ending, share)


@pytest.mark.parametrize("ending", ENDINGS)
@FAST
@given(changes=CHANGES)
def test_a_file_with_wrong_numbers_is_read_or_refused(valid, ending, changes):
    check_a_wrong_header(valid, ending, changes)


@pytest.mark.slow
@pytest.mark.parametrize("ending", ENDINGS)
@LONG
@given(content=RANDOM, share=SHARES, changes=CHANGES)
def test_damage_of_all_sorts_for_long(valid, ending, content, share, changes):
    check_random_bytes(valid, ending, content)
    check_a_cut(valid, ending, share)
    check_a_wrong_header(valid, ending, changes)


# --- what fuzzing found ------------------------------------------------------------------------


def refusal(folder: Path, ending: str, content: bytes) -> str:
    path = folder / f"run{ending}"
    path.write_bytes(content)
    with pytest.raises(RecordingError) as refused:
        read_recording(path)
    return str(refused.value)


@pytest.fixture
def impatient(monkeypatch):
    """A reader that is killed soon."""
    monkeypatch.setattr("noise.recordings.formats.isolated._PATIENCE", 2.0)


def test_a_text_of_4_gb_in_an_hdf5_attribute_is_refused(valid):
    folder, files = valid
    content = bytearray(files[".h5"])
    at = content.index(b"unit\0")
    length = content.index((2).to_bytes(4, "little"), at + 32)  # of "Pa", before its address
    content[length : length + 4] = b"\xff\xff\xff\xff"
    message = refusal(folder, ".h5", bytes(content))
    assert "is damaged or no HDF5 file" in message
    assert "memory" in message


def test_an_hdf5_heap_without_an_end_is_refused(valid, impatient):
    folder, files = valid
    content = bytearray(files[".h5"])
    heap = content.index(b"GCOL")
    content[heap + 24 : heap + 32] = bytes(8)  # length of the first text ...
    content[heap + 16 : heap + 18] = bytes(2)  # ... which is now free space that goes nowhere
    message = refusal(folder, ".h5", bytes(content))
    assert "is damaged or no HDF5 file (reading it took longer than 2 s)" in message


def test_an_mdf_group_that_follows_itself_is_refused(valid, impatient):
    folder, files = valid
    content = bytearray(files[".mf4"])
    group = content.index(b"##DG")
    content[group + 24 : group + 32] = group.to_bytes(8, "little")
    message = refusal(folder, ".mf4", bytes(content))
    assert "is damaged or no MDF file (reading it took longer than 2 s)" in message


def test_an_mdf_text_beyond_the_end_is_refused(valid):
    folder, files = valid
    content = bytearray(files[".mf4"])
    name = content.index(b"##CN") + 24 + 16  # third link of a channel
    content[name : name + 8] = (1 << 40).to_bytes(8, "little")
    assert "exceeds the file size" in refusal(folder, ".mf4", bytes(content))


def test_an_mdf_channel_outside_its_record_is_refused(valid):
    folder, files = valid
    content = bytearray(files[".mf4"])
    channel = content.index(b"##CN")
    links = int.from_bytes(content[channel + 16 : channel + 24], "little")
    offset = channel + 24 + 8 * links + 4
    content[offset : offset + 4] = (10**6).to_bytes(4, "little")
    assert "of a record of" in refusal(folder, ".mf4", bytes(content))


def test_a_tdms_file_of_an_unknown_version_is_refused(valid):
    folder, files = valid
    content = bytearray(files[".tdms"])
    content[8:12] = (9999).to_bytes(4, "little")
    assert "version 9999, expected 4712" in refusal(folder, ".tdms", bytes(content))


def test_an_unfinished_tdms_segment_is_refused(valid):
    folder, files = valid
    content = bytearray(files[".tdms"])
    content[12:20] = b"\xff" * 8
    assert "is truncated; its last segment goes on" in refusal(folder, ".tdms", bytes(content))


# --- whole files -------------------------------------------------------------------------------


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
