"""Frames wait in memory or in a file until changes of label are looked for: the same come back."""

import numpy as np
import pytest

from models.errors import RecordingError
from noise.labels import kept_frames
from noise.labels.windows import KeptFrames


@pytest.mark.parametrize("in_memory", [1 << 20, 100])
def test_frames_come_back_as_they_were_put_wherever_they_waited(monkeypatch, in_memory):
    monkeypatch.setattr(kept_frames, "_IN_MEMORY", in_memory)
    frames = np.random.default_rng(0).normal(size=(1000, 20)).astype(np.float32)
    kept = KeptFrames()
    for first in range(0, 1000, 90):  # the last of a page are put again with the next one
        kept.put(first, frames[first : first + 100])
    assert len(kept) == 1000
    for part in (slice(0, 1000), slice(87, 104), slice(990, 1010), slice(5, 5)):
        assert np.array_equal(kept[part], frames[part])


def test_a_full_disk_is_said_in_one_line(monkeypatch):
    def write(*_):
        raise OSError(28, "No space left on device")

    kept = KeptFrames()
    monkeypatch.setattr(kept._file, "write", write)
    with pytest.raises(RecordingError, match=r"temporary file cannot be written \(No space left"):
        kept.put(0, np.zeros((4, 2), dtype=np.float32))
