"""Recordings on disk: one file a format, the sidecar, and where a calibration can be found."""

from noise.recordings.files import find_recordings, read_recording
from noise.recordings.writing import write_recording

__all__ = ["find_recordings", "read_recording", "write_recording"]
