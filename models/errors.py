"""What can go wrong, as few exceptions as callers need to tell apart.

Every message names the place (file, channel, field), the value found and what would be right,
in one line: the command line shows it as it is.
"""

from __future__ import annotations

__all__ = ["BushingNoiseError", "ParameterError", "RecordingError"]


class BushingNoiseError(Exception):
    """Root of all errors that bushing-noise raises on purpose."""


class ParameterError(BushingNoiseError, ValueError):
    """A value, name or option that cannot be used; the call as a whole is refused."""


class RecordingError(BushingNoiseError):
    """A recording that cannot be read; a batch goes on with the next file."""
