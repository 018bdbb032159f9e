"""The command line of ``bushing-noise``: it finds the command, runs it, and reports errors.

Every command ends with an exit code and, where something went wrong, one line on standard error,
never with a traceback: 0 all done; 1 done, but inputs were refused; 2 the call cannot be used; 3
the program itself could not go on, for a defect, a full disk or too little memory. A program that
is interrupted (130) or whose reader goes away (141) ends as the shell has it. A defect is shown
with its traceback by ``python -X dev -m noise``.

Only the command that is called is imported, so that help is there at once.
"""

from __future__ import annotations

import argparse
import errno
import re
import sys
import traceback
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from models.errors import BushingNoiseError, RecordingError
from noise.base.progress import discard, note, say, set_verbosity
from noise.commands import COMMANDS, load_command
from noise.commands.options import COMMON, add_options, help_of, option_names

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

__all__ = ["main"]

_NAME = "bushing-noise"
_REFUSED = 1
_USAGE_ERROR = 2
_CANNOT_GO_ON = 3
_INTERRUPTED = 130  # 128 + SIGINT
_CLOSED_PIPE = 141  # 128 + SIGPIPE

_OF_THE_MACHINE = {
    getattr(errno, name)
    for name in ("ENOSPC", "EDQUOT", "EFBIG", "EMFILE", "ENFILE", "ENOMEM")
    if hasattr(errno, name)
}
"""Numbers of errors that no other call would avoid: no room, no memory, too many files open."""

_NEGATIVE = re.compile(r"-(\.?\d|inf|nan)", re.IGNORECASE)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    argv : sequence of str, optional
        Arguments without the name of the program; by default those of the process.

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
        if hasattr(stream, "reconfigure"):  # names of files that the terminal cannot show
            stream.reconfigure(errors="backslashreplace")
    with warnings.catch_warnings():
        warnings.showwarning = _show_warning
        try:
            return _report_errors(arguments)
        except BrokenPipeError:
            discard(sys.stdout)
            return _CLOSED_PIPE


def _report_errors(arguments: list[str]) -> int:
    """Run the command; say in one line what goes wrong."""
    try:
        code = _run(arguments)
        if sys.stdout is not None:
            sys.stdout.flush()
        return code
    except BushingNoiseError as error:
        if _is_of_the_machine(error):
            return _failed(str(error), _CANNOT_GO_ON)
        if isinstance(error, RecordingError):  # the only input that there was
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
        return _failed(message, _USAGE_ERROR if _is_of_the_path(error) else _CANNOT_GO_ON)
    except Exception as error:
        if sys.flags.dev_mode:
            raise
        place = traceback.extract_tb(error.__traceback__)[-1]
        where = f"{Path(place.filename).name}, line {place.lineno}"
        message = f"unexpected, please report: {type(error).__name__}: {error} ({where})"
        return _failed(message, _CANNOT_GO_ON)


def _is_of_the_machine(error: BaseException | None) -> bool:
    """Whether an error was raised because of a full disk or the like."""
    while error is not None:
        if isinstance(error, OSError) and error.errno in _OF_THE_MACHINE:
            return True
        error = error.__cause__ or error.__context__
    return False


def _is_of_the_path(error: OSError) -> bool:
    return error.filename is not None and error.errno not in _OF_THE_MACHINE


def _run(arguments: list[str]) -> int:
    parser = _parser(arguments)
    if not arguments:
        parser.print_help(sys.stderr)
        return _USAGE_ERROR
    command = arguments[0]
    if not command.startswith("-") and command not in COMMANDS:
        meant = _meant(command, COMMANDS)
        return _failed(f"there is no command {command!r}{meant} (see {_NAME} --help)")
    try:
        options, unknown = parser.parse_known_args(_with_negative_values(arguments))
    except SystemExit as stop:  # 0 after help, 2 after an error
        return stop.code if isinstance(stop.code, int) else 0
    if unknown:
        options_there = f"see {_NAME} {options.command} --help"
        known = ["--help", *option_names([*load_command(options.command).OPTIONS, *COMMON])]
        meant = _meant(unknown[0].partition("=")[0], known)
        return _failed(f"unrecognized: {' '.join(unknown)}{meant} ({options_there})")
    set_verbosity(quiet=options.quiet, verbose=options.verbose)
    try:
        return load_command(options.command).run(options)
    finally:
        set_verbosity()


def _meant(word: str, known: Iterable[str]) -> str:
    from models.schema import did_you_mean  # whose imports the help does without

    return did_you_mean(word, known)


def _failed(message: str, code: int = _USAGE_ERROR) -> int:
    say(f"{_NAME}: error: {message}", error=True)
    return code


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Tell an error of the call in one line."""
        _failed(f"{_plain(message)} (see {self.prog} --help)")
        raise SystemExit(_USAGE_ERROR)


def _plain(message: str) -> str:
    """Let a value's message follow its option: ``--speed is 'x', expected ...``."""
    return re.sub(r"^argument ([^:]+): is ", r"\1 is ", message)


class _Version(argparse.Action):
    def __call__(self, *_: object) -> None:
        """Print the installed version."""
        from importlib.metadata import PackageNotFoundError, version

        try:
            installed = version(_NAME)
        except PackageNotFoundError:
            installed = "(run from its source, not installed)"
        sys.stdout.write(f"{_NAME} {installed}\n")
        raise SystemExit(0)


def _parser(arguments: Sequence[str]) -> argparse.ArgumentParser:
    """All commands by name and line; options only of those that the arguments mention."""
    parser = _Parser(
        prog=_NAME,
        description="Simulate, hear, label and explain the creak, squawk and squeal of a rubber "
        "bushing.",
        epilog=f"{_NAME} COMMAND --help explains each command. Exit code 0: all done; 1: done, "
        "but some inputs were refused; 2: the call cannot be used; 3: the program could not go "
        "on, for a defect or a full disk.",
        allow_abbrev=False,
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version and stop")
    commands = parser.add_subparsers(
        dest="command", metavar="COMMAND", required=True, title="commands"
    )
    for name, line in COMMANDS.items():
        command = commands.add_parser(name, help=line, allow_abbrev=False)
        if name in arguments:
            texts = help_of(name)
            command.description, command.epilog = texts.description, texts.epilog or None
            add_options(command, [*load_command(name).OPTIONS, *COMMON], texts.options)
    return parser


def _with_negative_values(arguments: Sequence[str]) -> list[str]:
    """Tie negative values to their options: ``--speed -5..5`` becomes ``--speed=-5..5``.

    Left alone, the parser takes all but plain negative numbers for options.
    """
    tied: list[str] = []
    for argument in arguments:
        option = tied[-1] if tied else ""
        if option.startswith("--") and "=" not in option and _NEGATIVE.match(argument):
            tied[-1] = f"{option}={argument}"
        else:
            tied.append(argument)
    return tied


def _show_warning(message: Warning | str, *_: object, **__: object) -> None:
    note(str(message))
