"""Reading and writing of recordings: file formats, sidecars, calibration."""

from noise.recordings.files import find_recordings, read_recording
from noise.recordings.wav import write_recording

__all__ = ["find_recordings", "read_recording", "write_recording"]
