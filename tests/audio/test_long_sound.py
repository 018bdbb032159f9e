"""Sound that is read in parts is the sound as a whole, and a file of it is the same file."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
import soundfile
from hypothesis import given, settings, strategies as st

from models.recording import Channel, Recording
from noise.audio import filters, long_sound
from noise.audio.assessment import assess
from noise.audio.filters import SoundFilter
from noise.audio.gain import loudness, true_peak
from noise.audio.long_sound import LongSound, in_chunks
from noise.audio.loudness import LoudnessBlocks
from noise.audio.sound import playable, resampled
from noise.audio.wav import wav_bytes, wav_end, wav_header, wav_samples
from noise.cli import main
from noise.recordings import write_recording
from noise.recordings.blocks import open_blocks


def hiss(n, seed=1):
    return np.random.default_rng(seed).normal(size=n)


@given(st.integers(1, 400), st.data())
def test_chunks_give_any_part(n, data):
    whole = np.arange(float(n))
    read = in_chunks(lambda first, last: whole[first:last], n, 7)
    first = data.draw(st.integers(0, n))
    last = data.draw(st.integers(first, n + 5))
    np.testing.assert_array_equal(read(first, last), whole[first:last])


@pytest.mark.parametrize(
    ("rate", "new_rate"),
    [(44_100, 48_000), (192_000, 48_000), (30_000, 48_000), (51_200, 44_100), (8000, 48000)],
)
def test_sound_resampled_in_chunks_is_that_of_the_whole(rate, new_rate, monkeypatch):
    x = hiss(rate)
    monkeypatch.setattr(long_sound, "CHUNK", 5_000)
    monkeypatch.setattr(in_chunks, "__defaults__", (5_000,))
    made, whole = LongSound.of(x, rate).resampled(new_rate), resampled(x, rate, new_rate)
    assert made.n_samples == whole.size
    np.testing.assert_allclose(made.whole(), whole, rtol=0.0, atol=1e-13)
    played = LongSound.of(0.3 + x, rate).playable(new_rate, fade=0.3)
    np.testing.assert_allclose(
        np.concatenate(list(played.pieces())),
        playable(0.3 + x, rate, new_rate, fade=0.3),
        rtol=0.0,
        atol=1e-12,
    )


@settings(max_examples=20)
@given(st.floats(100.0, 1000.0), st.integers(2000, 9000))
def test_a_filter_in_chunks_is_that_of_the_whole(frequency, length):
    through, x = SoundFilter((frequency, 3000.0), (2.0 * frequency,)), hiss(60_000)
    whole = through.of(x, 48e3)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(filters, "CHUNK", length)
        parts = through.through(LongSound.of(x, 48e3))
        np.testing.assert_allclose(parts.whole(), whole, rtol=0.0, atol=1e-9)


def test_sounds_are_joined_with_silence_between_them():
    one, two = LongSound.of(np.ones(5), 10.0), LongSound.of(np.full(4, 2.0), 10.0)
    joined = LongSound.joined([one, two], [0, 7])
    assert joined.n_samples == 11
    np.testing.assert_array_equal(joined.read(3, 9), [1.0, 1.0, 0.0, 0.0, 2.0, 2.0])


@settings(max_examples=20)
@given(
    seconds=st.floats(0.4, 6.0),
    rate=st.sampled_from([44_100, 48_000]),
    loud=st.floats(-60.0, 0.0),
    chunk=st.integers(3_000, 100_000),
)
def test_loudness_is_that_of_pyloudnorm(seconds, rate, loud, chunk):
    import pyloudnorm

    n = round(seconds * rate) + 1
    x = hiss(n) * np.where(np.arange(n) % rate < 0.3 * rate, 1.0, 0.01) * 10 ** (loud / 20)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        expected = pyloudnorm.Meter(rate, filter_class="DeMan").integrated_loudness(x / 3.0)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(long_sound, "CHUNK", chunk)
        blocks = LoudnessBlocks.of(LongSound.of(x, rate))
    assert blocks.at(3.0) == pytest.approx(expected, abs=1e-9)
    assert loudness(x / 3.0, rate) == pytest.approx(expected, abs=1e-9)


def test_a_true_peak_across_two_blocks_is_found():
    x = np.zeros(1 << 20)
    x[(1 << 19) - 1 : (1 << 19) + 1] = 1.0
    assert true_peak(x, 48_000) == pytest.approx(true_peak(x[(1 << 19) - 999 :], 48_000), abs=1e-9)


def test_levels_of_a_long_sound_are_those_of_the_whole(monkeypatch):
    run = Recording(0.2 + hiss(400_000)[None], 48e3, (Channel("pressure"),))
    whole = assess(run).levels
    monkeypatch.setattr("features.long.levels.LONG", 0)
    long = assess(run).levels
    assert long.level == pytest.approx(whole.level, abs=1e-9)
    assert long.level_a == pytest.approx(whole.level_a, abs=1e-4)
    assert long.level_af_max == pytest.approx(whole.level_af_max, abs=1e-4)
    assert long.third_octaves == pytest.approx(whole.third_octaves, abs=1e-9, nan_ok=True)


@pytest.mark.parametrize("bits", [16, 24, 32])
def test_a_wav_file_in_pieces_is_the_same_file(bits):
    x = np.clip(0.2 * hiss(1001), -0.9, 0.9)
    pieces = b"".join(wav_samples(part, bits) for part in np.array_split(x, 3))
    parts = wav_header(x.size, 48_000, bits, description="told") + pieces + wav_end(x.size, bits)
    assert parts == wav_bytes(x, 48_000, bits, description="told")


@pytest.mark.parametrize("bits", [16, 24, 32])
def test_a_sound_beyond_four_gigabytes_is_a_file_that_the_library_reads(tmp_path, bits):
    n = 4 * ((1 << 33) // bits + 1001)
    path = tmp_path / "long.wav"
    with path.open("wb") as file:
        head = wav_header(n, 48_000, bits, description="told")
        file.write(head)
        file.truncate(len(head) + n * bits // 8)  # the samples are a hole in the file
        file.seek(len(head) + (n - 1) * bits // 8)
        file.write(wav_samples(np.array([0.5]), bits))
        file.write(wav_end(n, bits))
    assert path.stat().st_size > 1 << 32
    with soundfile.SoundFile(path) as sound:
        assert (sound.format, sound.frames, sound.samplerate) == ("RF64", n, 48_000)
        sound.seek(n - 1)
        assert sound.read(1).tolist() == [0.5]
    with open_blocks(path) as blocks:
        assert blocks is not None
        assert blocks.n_samples == n
        assert float(blocks.read(n - 1, n)[0, 0]) == 0.5


@pytest.mark.parametrize("more", [[], ["--band", "200..4000"], ["--match-loudness"]])
def test_render_in_blocks_writes_the_same_file(tmp_path, monkeypatch, more):
    run = Recording(
        np.stack([np.linspace(0.0, 5.0, 96_000), hiss(96_000)]), 30e3,
        (Channel("angle"), Channel("pressure")),
    )  # fmt: skip
    path = str(write_recording(tmp_path / "run.wav", run))
    assert main(["render", path, *more, "--out", str(tmp_path / "whole.wav")]) == 0
    monkeypatch.setattr("noise.recordings.blocks._LARGE", 0)
    monkeypatch.setattr("noise.recordings.chunks._CHUNK", 100_000)
    assert main(["render", path, *more, "--out", str(tmp_path / "blocks.wav")]) == 0
    whole, blocks = ((tmp_path / name).read_bytes() for name in ("whole.wav", "blocks.wav"))
    assert whole == blocks
