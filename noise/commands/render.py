"""``bushing-noise render``: recordings or conditions into audible WAV files.

Rig files and materials are simulated at the condition of the options, so that two designs are
compared at the same condition with the same random numbers. Invalid inputs are refused before the
first simulation.
"""

from __future__ import annotations

from argparse import ArgumentTypeError, Namespace
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from models.errors import BushingNoiseError, ParameterError, RecordingError
from models.recording import Recording
from noise.base.files import check_target
from noise.base.progress import counted, note, report, say, track
from noise.commands.condition import CONDITION, run_arguments, stated_options, with_notes
from noise.commands.options import (
    CALIBRATION,
    Option,
    band,
    check_folder,
    full_scale_of,
    number,
    refuse,
)

if TYPE_CHECKING:
    from noise.audio.render import Measured

_LOWEST, _NARROWEST = 1.0, 1.01  # lower end [Hz], and upper over lower end, for stable filters


def _band(text: str) -> tuple[float, float]:
    """Parse the frequency band [Hz] of a filter."""
    low, high = band(text)
    if low < _LOWEST or high < low * _NARROWEST:
        raise ArgumentTypeError(
            f"is {text!r}, expected a band that begins at {_LOWEST:g} Hz or above and is at least "
            f"{_NARROWEST - 1.0:.0%} wide"
        )
    return low, high


OPTIONS = (
    Option("inputs INPUT", str, count="*"),
    Option("--out AUDIO.wav|FOLDER", Path, required=True),
    Option("--ab"),
    Option("--gap S", number(least=0.0, most=60.0), 0.5),
    (Option("--pascal-per-full-scale PA", number(above=0.0, most=1e9)), Option("--match-loudness")),
    Option("--band LOW..HIGH", _band),
    *CALIBRATION,
    CONDITION,
)


def run(options: Namespace) -> int:
    """Render the sounds."""
    if options.ab and options.match_loudness:
        raise ParameterError("--ab plays all parts at the same gain; leave --match-loudness out")
    sources = _sources(options)
    if options.ab and len(sources) < 2:
        raise ParameterError("--ab puts two or more inputs behind one another; give a second one")
    folder = _folder(options, sources)
    check_target(options.out)
    return _render(options, _files(options, sources, folder), folder)


@dataclass(frozen=True)
class _Source:
    """Sound source.

    Parameters
    ----------
    name : str
        Name of the sound; for a recording its relative path without suffix.
    make : callable
        Reads or simulates the pressure channel.
    path : Path, optional
        Path of a recording.
    """

    name: str
    make: Callable[[], Recording]
    path: Path | None = None


def _sources(options: Namespace) -> list[_Source]:
    """Return the sound sources of the call with unique names, and print their notes."""
    condition = ["--" + name.replace("_", "-") for name in stated_options(options)]
    recorded = [text for text in options.inputs if not _is_rig(text)]
    if not options.inputs and not condition:
        raise ParameterError(
            "render needs a recording, or a condition such as --speed 5 to simulate"
        )
    if not recorded and (options.full_scale is not None or options.calibrator is not None):
        option = "--calibrator" if options.full_scale is None else "--full-scale"
        raise ParameterError(f"{option} is the calibration of a recording; none is given")
    if "" in options.inputs:
        raise ParameterError("one INPUT is empty; give a recording, a folder, or a rig file")
    if condition and recorded and len(recorded) == len(options.inputs):
        raise ParameterError(
            f"{condition[0]} describes a run to simulate, but {recorded[0]} is already recorded; "
            "give one or the other"
        )
    full_scale = full_scale_of(options)
    sources: list[_Source] = []
    notes: list[str] = []
    for text in options.inputs or [""]:
        names = {source.name.casefold() for source in sources}
        if text in recorded:
            sources += _recorded(Path(text), full_scale, names)
        else:
            name = Path(text).stem if text else options.out.name.removesuffix(".wav")
            source, its_notes = _run(_unique(name, names), options, text)
            sources.append(source)
            notes += its_notes
    note(*dict.fromkeys(notes))
    return sources


def _unique(name: str, names: set[str]) -> str:
    """Return a name, numbered if it is among others regardless of case, and add it to these."""
    numbered = (name if number == 1 else f"{name}-{number}" for number in count(1))
    unique = next(one for one in numbered if one.casefold() not in names)
    names.add(unique.casefold())
    return unique


def _is_rig(text: str) -> bool:
    """Whether an input is a rig file or a material."""
    from models.rig_file import material_of

    return text.lower().endswith(".toml") or material_of(Path(text)) is not None


def _recorded(path: Path, full_scale: float | None, names: set[str]) -> list[_Source]:
    """Return the sources of a recording or a folder."""
    from noise.recordings import find_recordings

    recordings = find_recordings(path)
    if not recordings:
        raise ParameterError(f"{path}: there are no recordings in it")
    return [
        _Source(
            _unique(str(Path(name).with_suffix("")), names), partial(_read, file, full_scale), file
        )
        for file, name in recordings
    ]


def _read(path: Path, full_scale: float | None) -> Recording:
    """Read the pressure of a recording."""
    from noise.audio.sound import pressure_recording
    from noise.recordings.files import open_blocks

    with open_blocks(path, full_scale=full_scale) as recording:
        _note_tracks(path, sum(one.kind == "pressure" for one in recording.channels))
        return pressure_recording(recording)


@cache  # a recording is read twice
def _note_tracks(path: Path, n: int) -> None:
    if n > 1:
        note(f"{path.name}: 1 of {n} channels of sound pressure is rendered")


def _run(name: str, options: Namespace, rig: str) -> tuple[_Source, tuple[str, ...]]:
    """Return the source of a simulated run, and its notes; `rig` is a file, a material or empty."""
    from noise.audio.sound import RATE

    if rig and options.rig is not None:
        raise ParameterError(f"--rig {options.rig} and {rig} are both rigs; give one")
    if rig:
        options = Namespace(**(vars(options) | {"rig": Path(rig)}))
    # At the rate of the sound: the rate of the rig would cut a creak off at 15 kHz.
    arguments, notes = run_arguments(options, RATE)

    @cache
    def simulated() -> Recording:
        from noise.audio.sound import pressure_recording
        from sim.run import simulate

        run = with_notes(simulate(**arguments), notes, arguments, name)
        return pressure_recording(replace(run, name=name))

    return _Source(name, simulated), notes


class _File(NamedTuple):
    """Output file with its name and its sound sources."""

    name: str
    target: Path
    sources: list[_Source]


def _recordings(file: _File, band: tuple[float, float] | None) -> list[Recording]:
    """Read or simulate the recordings of a file, filtered to a band [Hz]."""
    from noise.audio.sound import pressure_recording

    recordings = [source.make() for source in file.sources]
    return recordings if band is None else [pressure_recording(one, band) for one in recordings]


def _folder(options: Namespace, sources: list[_Source]) -> Path | None:
    """Return the output folder of a set; None for a single file."""
    out: Path = options.out
    several = len(sources) > 1 or any(Path(text).is_dir() for text in options.inputs)
    if options.ab or not (several or out.is_dir()):
        return None
    if out.suffix.lower() == ".wav":
        raise ParameterError(
            f"--out {out}: {counted(len(sources), 'sound')} are no single file; name a folder, "
            "or put them into one with --ab"
        )
    check_folder(out)
    return out


def _files(options: Namespace, sources: list[_Source], folder: Path | None) -> list[_File]:
    """Return the output files with their sources; refuse to overwrite an input or its sidecar."""
    from noise.audio.render import audio_path

    if folder is not None:
        files = [_File(one.name, audio_path(folder / one.name), [one]) for one in sources]
    else:
        target = audio_path(options.out)
        files = [_File(target.stem if options.ab else sources[0].name, target, sources)]
    inputs = [source.path for source in sources if source.path is not None]
    stems = {path.resolve().with_suffix("") for path in inputs}
    for _, target, _ in files:
        same = target.exists() and any(map(target.samefile, inputs))
        if same or target.resolve().with_suffix("") in stems:
            raise ParameterError(
                f"--out {options.out} would overwrite the recording or its sidecar"
            )
    return files


def _render(options: Namespace, files: list[_File], folder: Path | None) -> int:
    """Measure all sounds, write them at their gains, and return the exit code."""
    from noise.audio.render import COLUMNS, full_scales, measure, render
    from noise.base.tables import write_table

    measured: dict[str, Measured] = {}
    noise_names: dict[str, list[str]] = {}
    refused: dict[str, str] = {}
    for file in track(files, "measuring", unit="file"):
        try:
            recordings = _recordings(file, options.band)
            sound = measure(recordings, gap=options.gap, match=options.match_loudness)
        except (BushingNoiseError, MemoryError) as error:
            if folder is None and not isinstance(error, RecordingError):
                raise
            refused[file.name] = str(error) or "needs more memory than there is"
            refuse(refused[file.name], file.name)
            continue
        measured[file.name] = sound
        noise_names[file.name] = [_noise_name(one) for one in recordings]
    scales = full_scales(
        measured, pascal=options.pascal_per_full_scale, matched=options.match_loudness
    )
    unknown = [name for name, sound in measured.items() if not sound.calibrated]
    if unknown:
        note(
            f"{', '.join(unknown)}: not calibrated, so how loud it was is not known; levels are in "
            "dBFS only (--calibrator or --full-scale gives a calibration)"
        )
    rows: list[dict[str, object]] = []
    for file in files:
        name, target = file.name, file.target
        if name in refused:
            rows.append({"file": target.name, "error": refused[name]})
            continue
        sound, scale = measured[name], scales[name]
        recordings = _recordings(file, options.band)
        written, summary = render(target, recordings, sound, scale, gap=options.gap)
        file_name = target.name if folder is None else target.relative_to(folder).as_posix()
        rows += [{"file": file_name, **row} for row in written]
        calibration = f"full scale is {scale.value:.4g} Pa; " * sound.calibrated
        say(f"{name}: {calibration}in the file {summary}")
        for part, noise_name in zip(sound.parts, noise_names[name], strict=True):
            label = f"{name}: {part.about.name}" if options.ab else name
            say(f"{label}: {noise_name}{part.assessment.words(scale.value)}")
        report(target, target.with_suffix(".json"))
    if folder is not None:
        write_table(folder / "levels.csv", ("file", *COLUMNS, "error"), rows)
        report(folder / "levels.csv")
    return 1 if refused else 0


def _noise_name(recording: Recording) -> str:
    """Return the label of a sound and its frequency, such as ``squawk, 255 Hz, ``.

    Several labels are listed in the order in which they begin, without a frequency.
    """
    from noise.classifier import load_classifier
    from noise.labels.segments import file_label, label_recording

    try:
        segments = label_recording(recording, load_classifier())
    except BushingNoiseError:  # too short or sampled too slowly to be labelled
        return ""
    audible = dict.fromkeys(one.label for one in segments if one.label != "none")
    if len(audible) > 1:
        return f"{' and '.join(audible)}, "
    segment = file_label(segments)
    pitch = "" if segment.frequency is None else f"{segment.frequency:.0f} Hz, "
    return f"{segment.label}, {pitch}"
