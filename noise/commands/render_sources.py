"""Inputs of ``render``: recordings, folders of them, rig files, conditions in quotes.

A rig file and a condition are simulated; they take what they do not say themselves from the
options of the call, so that two designs meet the same condition, with the same random numbers.
Whatever cannot be used is refused before anything is simulated.
"""

from __future__ import annotations

import re
import shlex
from argparse import ArgumentParser, Namespace
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from models.errors import ParameterError
from noise.base.progress import note
from noise.commands.condition import CONDITION, given_options, run_arguments, with_notes
from noise.commands.options import add_options, full_scale_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from contextlib import ExitStack

    from models.recording import Recording
    from noise.audio.long_sound import AudibleSound
    from noise.recordings.meaning import PascalPerFullScale

__all__ = ["RecordedSource", "SimulatedSource", "Source", "sources_of"]

_ALONE = {"speed": "oscillate", "oscillate": "speed"}
"""Options of which one takes the other's place."""


@dataclass(frozen=True)
class RecordedSource:
    """A recording on disk; `name` is its path without the ending, below the folder named."""

    name: str
    path: Path
    full_scale: PascalPerFullScale | None

    def heard(self, number: int, stack: ExitStack) -> AudibleSound:
        """Open it, until `stack` is closed; the same whatever `number`."""
        del number
        from noise.audio.long_sound import AudibleSound
        from noise.recordings import read_recording
        from noise.recordings.blocks import open_blocks

        opened = stack.enter_context(open_blocks(self.path, full_scale=self.full_scale))
        return AudibleSound.of(opened or read_recording(self.path, full_scale=self.full_scale))


@dataclass(frozen=True)
class SimulatedSource:
    """A condition of the rig; `arguments` are those of `sim.run.simulate`."""

    name: str
    arguments: Mapping[str, Any]
    seed: int
    notes: tuple[str, ...] = ()
    done: dict[int, Recording] = field(default_factory=dict)

    def heard(self, number: int, stack: ExitStack) -> AudibleSound:
        """Return the run of this number; nothing is left for `stack` to close."""
        del stack
        from noise.audio.long_sound import AudibleSound

        return AudibleSound.of(self.recording(number))

    def recording(self, number: int) -> Recording:
        """Simulate the run of this number, each with random numbers of its own."""
        if number not in self.done:
            import numpy as np

            from sim.run import simulate

            arguments = dict(self.arguments)
            if number:
                arguments["rng"] = np.random.default_rng([self.seed, number])
            # Its sound is all that is heard of it, and may have to be kept for long.
            made = simulate(**arguments)
            run = made.recording if number else with_notes(made, self.notes, arguments, self.name)
            row = run.first("pressure")
            if row is not None:
                samples, channels = run.samples[row : row + 1].copy(), (run.channels[row],)
                run = replace(run, samples=samples, channels=channels)
            self.done[number] = replace(run, name=self.name)
        return self.done[number]


Source = RecordedSource | SimulatedSource


def sources_of(options: Namespace) -> list[Source]:
    """Return what a call of ``render`` is to make audible.

    Raises
    ------
    ParameterError
        An input does not exist or does not go with the options.
    """
    given = ["--" + name.replace("_", "-") for name in given_options(options)]
    simulated = [text for text in options.inputs if _is_condition(text) or _is_rig(text)]
    recorded = [text for text in options.inputs if text not in simulated]
    if not options.inputs and not given:
        raise ParameterError(
            "render needs a recording, or a condition such as --speed 5 to simulate"
        )
    if not recorded and (options.full_scale is not None or options.calibrator is not None):
        option = "--calibrator" if options.full_scale is None else "--full-scale"
        raise ParameterError(f"{option} is the calibration of a recording; none is given")
    if "" in options.inputs:
        raise ParameterError("one INPUT is empty; give a recording, a folder, or a condition")
    if recorded and given and not simulated:
        raise ParameterError(
            f"{given[0]} describes a run to simulate, but {recorded[0]} is already recorded; "
            "give one or the other"
        )
    if recorded and not options.ab and options.repeats > 1:
        raise ParameterError(
            f"--repeats simulates a run again, but {recorded[0]} is already recorded, and a "
            "recording is not looped; record it for longer"
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
    named = _with_names_of_their_own(sources)
    _tell_notes([source for source in named if isinstance(source, SimulatedSource)])
    return named


def _tell_notes(sources: Sequence[SimulatedSource]) -> None:
    """Note each thing once: what holds of all runs as such, the rest with the names of its runs."""
    found: dict[str, list[str]] = {}
    for source in sources:
        for text in source.notes:
            found.setdefault(text, []).append(source.name)
    for text, names in found.items():
        note(text if len(names) == len(sources) else f"{', '.join(names)}: {text}")


def _is_condition(text: str) -> bool:
    return text.lstrip().startswith("-")


def _is_rig(text: str) -> bool:
    return text.lower().endswith(".toml")


def _recorded(path: Path, full_scale: PascalPerFullScale | None) -> list[Source]:
    from noise.recordings import find_recordings

    found = find_recordings(path)
    if not found:
        raise ParameterError(f"{path}: there are no recordings in it")
    return [
        RecordedSource(str(Path(name).with_suffix("")), file, full_scale) for file, name in found
    ]


def _simulated(text: str, options: Namespace) -> Source:
    if _is_rig(text) and not _is_condition(text):
        if options.rig is not None:
            raise ParameterError(f"--rig {options.rig} and {text} are both rig files; give one")
        return _source(Path(text).stem, _over(options, {"rig": Path(text)}))
    parser = _ConditionParser(text)
    add_options(parser, [CONDITION])
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise ParameterError(f"condition {text!r}: {error}") from None
    values = given_options(parser.parse_args(words))
    name = re.sub(r"[^\w.]+", "-", text).strip("-.")
    return _source(name, _over(options, values))


def _over(options: Namespace, values: Mapping[str, Any]) -> Namespace:
    names = [row.attribute for row in CONDITION.rows]
    merged = {name: getattr(options, name) for name in (*names, "seed", "rate")}
    for name in values:
        if name in _ALONE:
            merged[_ALONE[name]] = None
    return Namespace(**(merged | dict(values)))


def _source(name: str, options: Namespace) -> Source:
    # At the rate of the sound: the rig's own rate would cut the creak off at 15 kHz.
    arguments, notes = run_arguments(options, options.rate)
    return SimulatedSource(name, arguments, options.seed, notes)


def _with_names_of_their_own(sources: list[Source]) -> list[Source]:
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
    """Reads the options of a condition in quotes."""

    def __init__(self, text: str) -> None:
        super().__init__(prog="condition", add_help=False, allow_abbrev=False)
        self._text = text

    def error(self, message: str) -> NoReturn:
        """Refuse it in one line."""
        raise ParameterError(f"condition {self._text!r}: {message.removeprefix('argument ')}")
