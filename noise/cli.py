"""Command line of ``bushing-noise``: parses the arguments, runs a command and reports errors.

Exit codes: 0 success; 1 done, but inputs were refused; 2 invalid call; 3 the program could not go
on, because of a defect, a full disk or too little memory; 130 interrupted; 141 the reader of the
output has gone. Errors are reported in one line on standard error; ``python -X dev -m noise`` shows
the traceback of a defect.

Only the module of the command is imported, so that help is fast.
"""

from __future__ import annotations

import argparse
import errno
import re
import sys
import traceback
import warnings
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import NoReturn

from models.errors import BushingNoiseError, RecordingError
from models.schema import did_you_mean
from noise.base.progress import discard, note, say, set_verbosity
from noise.commands import COMMANDS, load_command
from noise.commands.options import COMMON, add_options, help_of, option_names

_NAME = "bushing-noise"
_REFUSED = 1
_USAGE_ERROR = 2
_CANNOT_GO_ON = 3
_INTERRUPTED = 130  # 128 + SIGINT
_CLOSED_PIPE = 141  # 128 + SIGPIPE

_MACHINE_ERRORS = {
    getattr(errno, name)
    for name in ("ENOSPC", "EDQUOT", "EFBIG", "EMFILE", "ENFILE", "ENOMEM")
    if hasattr(errno, name)
}
"""Error numbers of a full disk, too little memory or too many open files."""

_NEGATIVE = re.compile(r"-(\.?\d|inf|nan)", re.IGNORECASE)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    argv : sequence of str, optional
        Arguments without the name of the program (default: those of the process).

    Returns
    -------
    int
        Exit code.

    Examples
    --------
    >>> main(["--help"])
    usage: bushing-noise ...
    0
    """
    arguments = list(sys.argv[1:] if argv is None else argv)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # file names may not fit the encoding of the terminal
            stream.reconfigure(errors="backslashreplace")
    with warnings.catch_warnings():
        warnings.showwarning = lambda message, *_, **__: note(str(message))
        try:
            return _report_errors(arguments)
        except BrokenPipeError:
            discard(sys.stdout)
            return _CLOSED_PIPE


def _report_errors(arguments: list[str]) -> int:
    """Run the command and report errors in one line."""
    try:
        code = _run(arguments)
        if sys.stdout is not None:
            sys.stdout.flush()
        return code
    except BushingNoiseError as error:
        if _is_machine_error(error):
            return _failed(str(error), _CANNOT_GO_ON)
        if isinstance(error, RecordingError):  # the only input was refused
            say(f"{_NAME}: refused: {error}", error=True)
            return _REFUSED
        return _failed(str(error))
    except MemoryError:
        message = "this needs more memory than there is; try a shorter recording"
        return _failed(message, _CANNOT_GO_ON)
    except KeyboardInterrupt:
        say(f"{_NAME}: interrupted", error=True)
        return _INTERRUPTED
    except BrokenPipeError:
        raise
    except OSError as error:
        discard(sys.stdout)
        message = f"{error.filename or 'output'}: {error.strerror or error}"
        usage = error.filename is not None and error.errno not in _MACHINE_ERRORS
        return _failed(message, _USAGE_ERROR if usage else _CANNOT_GO_ON)
    except Exception as error:
        if sys.flags.dev_mode:
            raise
        place = traceback.extract_tb(error.__traceback__)[-1]
        where = f"{Path(place.filename).name}, line {place.lineno}"
        message = f"unexpected, please report: {type(error).__name__}: {error} ({where})"
        return _failed(message, _CANNOT_GO_ON)


def _is_machine_error(error: BaseException | None) -> bool:
    """Whether an error has a cause in `_MACHINE_ERRORS`."""
    while error is not None:
        if isinstance(error, OSError) and error.errno in _MACHINE_ERRORS:
            return True
        error = error.__cause__ or error.__context__
    return False


def _run(arguments: list[str]) -> int:
    """Parse the arguments and run the command; return the exit code."""
    arguments = _common_options_last(arguments)
    if arguments[:1] == ["help"]:  # as many programs have it
        arguments = [*arguments[1:2], "--help"]
    parser = _parser(arguments)
    if not arguments:
        parser.print_help(sys.stderr)
        return _USAGE_ERROR
    command = arguments[0]
    if command == "--version":
        from importlib.metadata import PackageNotFoundError, version

        installed = "(run from its source, not installed)"
        with suppress(PackageNotFoundError):
            installed = version(_NAME)
        sys.stdout.write(f"{_NAME} {installed}\n")
        return 0
    if not command.startswith("-") and command not in COMMANDS:
        advice = did_you_mean(command, COMMANDS)
        return _failed(f"there is no command {command!r}{advice} (see {_NAME} --help)")
    try:
        options, unknown = parser.parse_known_args(_with_negative_values(arguments))
    except SystemExit as stop:  # 0 after help, 2 after an error
        return stop.code if isinstance(stop.code, int) else 0
    if unknown:
        known = ["--help", *option_names([*load_command(options.command).OPTIONS, *COMMON])]
        advice = did_you_mean(unknown[0].partition("=")[0], known)
        see = f"see {_NAME} {options.command} --help"
        return _failed(f"unrecognized: {' '.join(unknown)}{advice} ({see})")
    set_verbosity(quiet=options.quiet, verbose=options.verbose)
    try:
        return int(load_command(options.command).run(options))
    finally:
        set_verbosity()


def _failed(message: str, code: int = _USAGE_ERROR) -> int:
    """Print an error and return the exit code."""
    say(f"{_NAME}: error: {message}", error=True)
    return code


class _Parser(argparse.ArgumentParser):
    """Parser that reports an invalid call in one line."""

    def error(self, message: str) -> NoReturn:
        """Print an error and exit."""
        # "argument --speed: is 'x', expected ..." becomes "--speed is 'x', expected ...".
        plain = re.sub(r"^argument ([^:]+): is ", r"\1 is ", message)
        _failed(f"{plain} (see {self.prog} --help)")
        raise SystemExit(_USAGE_ERROR)


def _parser(arguments: Sequence[str]) -> argparse.ArgumentParser:
    """Return a parser of all commands, with options only for those among the arguments."""
    parser = _Parser(
        prog=_NAME,
        description="Simulate, hear, label and explain the creak, squawk and squeal of a rubber "
        "bushing.",
        epilog=f"{_NAME} COMMAND --help explains each command. Exit code 0: all done; 1: done, "
        "but some inputs were refused; 2: the call cannot be used; 3: the program could not go "
        "on, for a defect or a full disk.",
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="store_true", help="print the version and stop")
    commands = parser.add_subparsers(
        dest="command", metavar="COMMAND", required=True, title="commands"
    )
    for name, line in COMMANDS.items():
        command = commands.add_parser(name, help=line, allow_abbrev=False)
        if name in arguments:
            command.description, command.epilog, texts = help_of(name)
            add_options(command, [*load_command(name).OPTIONS, *COMMON], texts)
    return parser


def _common_options_last(arguments: list[str]) -> list[str]:
    """Move options of all commands from before the command to behind it."""
    first = next((i for i, one in enumerate(arguments) if one in COMMANDS), 0)
    before = arguments[:first]
    if set(before) <= set(option_names(COMMON)):
        return [*arguments[first : first + 1], *before, *arguments[first + 1 :]]
    return arguments


def _with_negative_values(arguments: Sequence[str]) -> list[str]:
    """Join negative values with their options: ``--speed -5..5`` becomes ``--speed=-5..5``.

    argparse would take such a value for an option, unless it is a plain number.
    """
    joined: list[str] = []
    for argument in arguments:
        option = joined[-1] if joined else ""
        if option.startswith("--") and "=" not in option and _NEGATIVE.match(argument):
            joined[-1] = f"{option}={argument}"
        else:
            joined.append(argument)
    return joined
