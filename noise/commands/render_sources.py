"""Sound sources of ``render``: recordings, folders, rig files, and conditions in quotes.

Rig files and conditions are simulated. They take missing options from the call, so that two designs
are compared at the same condition with the same random numbers. Invalid inputs are refused before
the first simulation.
"""

from __future__ import annotations

import re
import shlex
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from models.errors import ParameterError
from models.recording import Recording
from noise.base.progress import note
from noise.commands.condition import CONDITION, run_arguments, stated_options, with_notes
from noise.commands.options import add_options, full_scale_of

if TYPE_CHECKING:
    from noise.recordings.interpretation import PascalPerFullScale

_ALTERNATIVES = {"speed": "oscillate", "oscillate": "speed"}
"""Options that replace each other."""


@dataclass(frozen=True)
class Source:
    """Sound source.

    Parameters
    ----------
    name : str
        Name of the sound; for a recording its relative path without suffix.
    make : callable
        ``make(name)`` reads or simulates the pressure channel.
    path : Path, optional
        Path of a recording.
    notes : tuple of str
        Notes to print before the simulation.
    """

    name: str
    make: Callable[[str], Recording]
    path: Path | None = None
    notes: tuple[str, ...] = ()


def sources_of(options: Namespace) -> list[Source]:
    """Return the sound sources of a ``render`` call.

    Raises
    ------
    ParameterError
        An input does not exist or does not go with the options.
    """
    condition = ["--" + name.replace("_", "-") for name in stated_options(options)]
    simulated = [
        text for text in options.inputs if _is_condition(text) or text.lower().endswith(".toml")
    ]
    recorded = [text for text in options.inputs if text not in simulated]
    if not options.inputs and not condition:
        raise ParameterError(
            "render needs a recording, or a condition such as --speed 5 to simulate"
        )
    if not recorded and (options.full_scale is not None or options.calibrator is not None):
        option = "--calibrator" if options.full_scale is None else "--full-scale"
        raise ParameterError(f"{option} is the calibration of a recording; none is given")
    if "" in options.inputs:
        raise ParameterError("one INPUT is empty; give a recording, a folder, or a condition")
    if recorded and condition and not simulated:
        raise ParameterError(
            f"{condition[0]} describes a run to simulate, but {recorded[0]} is already recorded; "
            "give one or the other"
        )
    full_scale = full_scale_of(options)
    sources: list[Source] = []
    for text in options.inputs:
        if text in simulated:
            sources.append(_simulated(text, options))
        else:
            sources += _recorded(Path(text), full_scale)
    if not options.inputs:
        sources.append(_source(options.out.name.removesuffix(".wav"), options))
    named = _with_unique_names(sources)
    _print_notes([source for source in named if source.path is None])
    return named


def _print_notes(sources: Sequence[Source]) -> None:
    """Print each note once; notes that do not apply to all runs name their runs."""
    names_by_note: dict[str, list[str]] = {}
    for source in sources:
        for text in source.notes:
            names_by_note.setdefault(text, []).append(source.name)
    for text, names in names_by_note.items():
        note(text if len(names) == len(sources) else f"{', '.join(names)}: {text}")


def _is_condition(text: str) -> bool:
    """Whether an input is a condition in quotes."""
    return text.lstrip().startswith("-")


def _recorded(path: Path, full_scale: PascalPerFullScale | None) -> list[Source]:
    """Return the sources of a recording or a folder."""
    from noise.recordings import find_recordings

    recordings = find_recordings(path)
    if not recordings:
        raise ParameterError(f"{path}: there are no recordings in it")
    return [
        Source(str(Path(name).with_suffix("")), partial(_read, file, full_scale), file)
        for file, name in recordings
    ]


def _read(path: Path, full_scale: PascalPerFullScale | None, _: str) -> Recording:
    """Read the pressure of a recording."""
    from noise.audio.sound import pressure_recording
    from noise.recordings.files import open_blocks

    with open_blocks(path, full_scale=full_scale) as recording:
        return pressure_recording(recording)


def _simulated(text: str, options: Namespace) -> Source:
    """Return the source of a rig file or a condition."""
    if not _is_condition(text):
        if options.rig is not None:
            raise ParameterError(f"--rig {options.rig} and {text} are both rig files; give one")
        return _source(Path(text).stem, _over(options, {"rig": Path(text)}))
    parser = _ConditionParser(text)
    add_options(parser, [CONDITION])
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise ParameterError(f"condition {text!r}: {error}") from None
    values = stated_options(parser.parse_args(words))
    name = re.sub(r"[^\w.]+", "-", text).strip("-.")
    return _source(name, _over(options, values))


def _over(options: Namespace, values: Mapping[str, Any]) -> Namespace:
    """Return the options of a condition, with some values replaced."""
    names = [row.attribute for row in CONDITION.rows]
    merged = {name: getattr(options, name) for name in (*names, "seed", "rate")}
    for name in values:
        if name in _ALTERNATIVES:
            merged[_ALTERNATIVES[name]] = None
    return Namespace(**(merged | dict(values)))


def _source(name: str, options: Namespace) -> Source:
    """Return the source of a simulated run."""
    # At the rate of the sound: the rate of the rig would cut a creak off at 15 kHz.
    arguments, notes = run_arguments(options, options.rate)

    @cache
    def simulated(name: str) -> Recording:
        from noise.audio.sound import pressure_recording
        from sim.run import simulate

        run = with_notes(simulate(**arguments), notes, arguments, name)
        return pressure_recording(replace(run, name=name))

    return Source(name, simulated, notes=notes)


def _with_unique_names(sources: list[Source]) -> list[Source]:
    """Return the sources with numbers added to duplicate names."""
    taken: set[str] = set()
    named: list[Source] = []
    for source in sources:
        name, number = source.name, 2
        while name.casefold() in taken:
            name, number = f"{source.name}-{number}", number + 1
        taken.add(name.casefold())
        named.append(replace(source, name=name))
    return named


class _ConditionParser(ArgumentParser):
    """Parser of a condition in quotes."""

    def __init__(self, text: str) -> None:
        super().__init__(prog="condition", add_help=False, allow_abbrev=False)
        self._text = text

    def error(self, message: str) -> NoReturn:
        """Raise an error of parsing as ParameterError."""
        raise ParameterError(f"condition {self._text!r}: {message.removeprefix('argument ')}")
