"""Exceptions of bushing-noise.

Every message names the place (file, channel, field), the value and what would be right, in one
line, which the command line prints unchanged. Values come from files and may be long or contain
line breaks, so the root class turns each message into one line of bounded length.
"""

from collections.abc import Iterator
from contextlib import contextmanager

_LONGEST = 2000
"""Longest message in characters; the rest is cut off."""


class BushingNoiseError(Exception):
    r"""Root of all errors that bushing-noise raises on purpose.

    Parameters
    ----------
    message : str
        Message, which becomes one line of bounded length.

    Examples
    --------
    >>> print(BushingNoiseError("run07.json: unit is 'N\nm'; it must be one of a channel's"))
    run07.json: unit is 'N m'; it must be one of a channel's
    """

    def __init__(self, message: str = "") -> None:
        line = " ".join(str(message).splitlines())
        super().__init__(line if len(line) <= _LONGEST else f"{line[:_LONGEST]} ...")


class ParameterError(BushingNoiseError, ValueError):
    """Error for an unusable value, name or option; the whole call is refused."""


class RecordingError(BushingNoiseError):
    """Error for a recording that cannot be read; a batch continues with the next file."""


@contextmanager
def naming(place: str, error: type[BushingNoiseError] | None = None) -> Iterator[None]:
    """Prefix the errors of the block with a place, such as an option.

    Parameters
    ----------
    place : str
        Prefix, including the separator before the message.
    error : type, optional
        Type of the raised error; by default that of the original.

    Raises
    ------
    BushingNoiseError
        The error of the block, with the prefix.

    Examples
    --------
    >>> with naming("--rig: "):
    ...     raise ParameterError("rig.toml: there is no such file")
    Traceback (most recent call last):
    models.errors.ParameterError: --rig: rig.toml: there is no such file
    """
    try:
        yield
    except BushingNoiseError as wrong:
        raise (error or type(wrong))(f"{place}{wrong}") from None


def not_installed(what: str, package: str, extra: str) -> str:
    """Return the message for a missing extra; `what` is a subject with its verb.

    Examples
    --------
    >>> not_installed("Parquet needs", "pyarrow", "parquet")
    'Parquet needs pyarrow, which is not installed; run: pip install "bushing-noise[parquet]"'
    """
    command = f'pip install "bushing-noise[{extra}]"'
    return f"{what} {package}, which is not installed; run: {command}"
