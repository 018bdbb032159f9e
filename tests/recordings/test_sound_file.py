from __future__ import annotations

import tracemalloc
from types import SimpleNamespace

import numpy as np
import pytest
import soundfile

from models.errors import RecordingError
from noise.recordings.formats.sound_file import open_sound_file

RATE = 48_000
FORMATS = [
    ("wav", "FLOAT", False),
    ("wav", "DOUBLE", False),
    ("wav", "PCM_16", True),
    ("wav", "PCM_24", True),
    ("wav", "IMA_ADPCM", True),
    ("flac", "PCM_16", True),
    ("aiff", "PCM_24", True),
    ("rf64", "FLOAT", False),
    ("ogg", "VORBIS", True),
    ("mp3", "MPEG_LAYER_III", True),
]


def sine(n_samples: int = 20_000, n_channels: int = 1) -> np.ndarray:
    phase = 2 * np.pi * 500 * np.arange(n_samples) / RATE
    return 0.5 * np.sin(phase[:, None] + np.arange(n_channels))


def read_sound_file(path):
    with open_sound_file(path) as raw:
        return SimpleNamespace(**vars(raw), samples=raw.whole())


@pytest.mark.parametrize(("ending", "subtype", "fractional"), FORMATS)
def test_every_format_gives_its_samples_and_how_they_are_coded(
    tmp_path, ending, subtype, fractional
):
    path = tmp_path / f"run.{ending}"
    written = sine(150_000, 2)
    soundfile.write(path, written, RATE, subtype=subtype, format=ending.upper())
    raw = read_sound_file(path)
    assert (raw.rate, raw.fractional) == (RATE, fractional)
    assert np.array_equal(raw.samples, soundfile.read(path, always_2d=True)[0].T)
    n = min(len(written), raw.samples.shape[1])
    assert n > 0.99 * len(written)
    assert np.abs(raw.samples[:, 5000:n] - written.T[:, 5000:n]).max() < 0.1


@pytest.mark.parametrize(("ending", "subtype", "fractional"), FORMATS)
@pytest.mark.parametrize("share", [0.5, 0.9])
def test_a_file_cut_short_is_refused(tmp_path, ending, subtype, fractional, share):
    path = tmp_path / f"run.{ending}"
    soundfile.write(path, sine(60_000), RATE, subtype=subtype, format=ending.upper())
    whole = path.read_bytes()
    path.write_bytes(whole[: int(len(whole) * share)])
    try:
        raw = read_sound_file(path)
    except RecordingError as error:
        assert str(path) in str(error)  # noqa: PT017
    else:
        # Without a length in its header, a shorter stream of OGG is a stream of OGG.
        assert ending == "ogg"
        assert raw.samples.shape[1] < 60_000


def test_a_header_that_announces_the_moon_takes_no_memory(tmp_path):
    path = tmp_path / "run.flac"
    soundfile.write(path, sine(), RATE)
    content = bytearray(path.read_bytes())
    content[21] |= 0x0F  # the 36 bits that count the samples
    content[22:26] = b"\xff" * 4
    path.write_bytes(content)
    tracemalloc.start()
    try:
        with pytest.raises(RecordingError, match="68719476735 samples, more than a file of this"):
            read_sound_file(path)
        assert tracemalloc.get_traced_memory()[1] < 1e6
    finally:
        tracemalloc.stop()


def test_reading_takes_the_memory_of_the_result(tmp_path):
    path = tmp_path / "run.wav"
    soundfile.write(path, np.zeros((1_000_000, 4), np.float32), RATE, subtype="FLOAT")
    tracemalloc.start()
    try:
        raw = read_sound_file(path)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert raw.samples.nbytes == 2 * 16_000_000
    assert peak < 1.2 * raw.samples.nbytes
