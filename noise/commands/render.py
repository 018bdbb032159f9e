"""``bushing-noise render``: recordings or conditions into audible WAV files."""

from __future__ import annotations

import math
from argparse import ArgumentTypeError, Namespace
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from models.errors import BushingNoiseError, ParameterError, RecordingError
from noise.base.files import check_target
from noise.base.progress import counted, note, report, say, track
from noise.commands.condition import CONDITION
from noise.commands.options import (
    CALIBRATION,
    OneOf,
    Option,
    band,
    check_folder,
    number,
    one_of,
    refuse,
)

if TYPE_CHECKING:
    from models.recording import Recording
    from noise.audio.render import FullScale, Measured, Part
    from noise.commands.render_sources import Source


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
    Option("--rate 44100|48000", one_of(44100, 48000), 48000),
    Option("--bits 16|24|32", one_of(16, 24, 32), 24),
    Option("--fade S", number(least=0.0, most=60.0), 0.010),
    OneOf(
        Option("--pascal-per-full-scale PA", number(above=0.0, most=1e9)),
        Option("--match-loudness"),
    ),
    Option("--band LOW..HIGH", _band),
    *CALIBRATION,
    CONDITION,
)


def run(options: Namespace) -> int:
    """Render the sounds."""
    from noise.commands.render_sources import sources_of

    if options.ab and options.match_loudness:
        raise ParameterError("--ab plays all parts at the same gain; leave --match-loudness out")
    sources = sources_of(options)
    if options.ab and len(sources) < 2:
        raise ParameterError("--ab puts two or more inputs behind one another; give a second one")
    folder = _folder(options, sources)
    check_target(options.out)
    files = _files(options, sources, folder)
    _check_overwrite(options.out, sources, files)
    return _render(options, files, folder)


class _File(NamedTuple):
    """Output file with its name and its sound sources."""

    name: str
    target: Path
    sources: list[Source]


def _recordings(file: _File, band: tuple[float, float] | None) -> list[Recording]:
    """Read or simulate the recordings of a file, filtered to a band [Hz]."""
    from noise.audio.sound import pressure_recording

    recordings = [source.make(source.name) for source in file.sources]
    return recordings if band is None else [pressure_recording(one, band) for one in recordings]


def _folder(options: Namespace, sources: list[Source]) -> Path | None:
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


def _files(options: Namespace, sources: list[Source], folder: Path | None) -> list[_File]:
    """Return the output files with their sources."""
    from noise.audio.audio_file import audio_path

    if folder is not None:
        return [_File(one.name, audio_path(folder / one.name), [one]) for one in sources]
    target = audio_path(options.out)
    return [_File(target.stem if options.ab else sources[0].name, target, sources)]


def _check_overwrite(out: Path, sources: list[Source], files: list[_File]) -> None:
    """Refuse to overwrite an input or its sidecar."""
    inputs = [source.path for source in sources if source.path is not None]
    stems = {path.resolve().with_suffix("") for path in inputs}
    for _, target, _ in files:
        same = target.exists() and any(map(target.samefile, inputs))
        if same or target.resolve().with_suffix("") in stems:
            raise ParameterError(f"--out {out} would overwrite the recording or its sidecar")


def _render(options: Namespace, files: list[_File], folder: Path | None) -> int:
    """Measure all sounds, write them at their gains, and return the exit code."""
    from noise.audio.render import COLUMNS, full_scales, measure, render
    from noise.base.tables import write_table

    measured: dict[str, Measured] = {}
    noise_names: dict[str, list[str]] = {}
    refused: dict[str, str] = {}
    shape = {"rate": options.rate, "gap": options.gap, "fade": options.fade}
    for file in track(files, "measuring", unit="file"):
        try:
            recordings = _recordings(file, options.band)
            sound = measure(recordings, **shape, match=options.match_loudness)
        except (BushingNoiseError, MemoryError) as error:
            if folder is None and not isinstance(error, RecordingError):
                raise
            refused[file.name] = str(error) or "needs more memory than there is"
            refuse(refused[file.name], file.name)
            continue
        measured[file.name] = sound
        noise_names[file.name] = [_noise_name(one) for one in recordings]
        for text in dict.fromkeys(filter(None, map(_filter_note, sound.parts))):
            say(f"{file.name}: {text}")
    scales = full_scales(
        measured, pascal=options.pascal_per_full_scale, matched=options.match_loudness
    )
    _notes(measured)
    faint = _note_faint(measured, scales)
    rows: list[dict[str, object]] = []
    for index, (name, target, _) in enumerate(files):
        if name not in measured:
            rows.append({"file": target.name, "error": refused[name]})
            continue
        sound, scale = measured[name], scales[name]
        written, summary = render(
            target,
            _recordings(files[index], options.band),
            sound,
            scale,
            **shape,
            bits=options.bits,
            seed=(options.seed, index),
            note=faint.get(name),
        )
        file_name = target.name if folder is None else target.relative_to(folder).as_posix()
        rows += [
            {"file": file_name, **row, "filter": _filter_note(part), "note": faint.get(name)}
            for row, part in zip(written, sound.parts, strict=True)
        ]
        calibration = f"full scale is {scale.value:.4g} Pa; " * sound.calibrated
        say(f"{name}: {calibration}in the file {summary}")
        several = len(sound.parts) > 1
        for part, noise_name in zip(sound.parts, noise_names[name], strict=True):
            label = f"{name}: {part.about.name}" if several else name
            say(f"{label}: {noise_name}{part.assessment.words(scale.value)}")
        report(target, target.with_suffix(".json"))
    if folder is not None:
        write_table(folder / "levels.csv", ("file", *COLUMNS, "filter", "note", "error"), rows)
        report(folder / "levels.csv")
    return 1 if refused else 0


def _noise_name(recording: Recording) -> str:
    """Return the label of a sound and its frequency, such as ``squawk, 255 Hz, ``."""
    from noise.classifier import load_classifier
    from noise.labels.segments import file_label, label_recording

    try:
        segment = file_label(label_recording(recording, load_classifier()))
    except BushingNoiseError:  # too short or sampled too slowly to be labelled
        return ""
    pitch = "" if segment.frequency is None else f"{segment.frequency:.0f} Hz, "
    return f"{segment.label}, {pitch}"


def _filter_note(part: Part) -> str | None:
    """Return the note on the filter of a part."""
    last = part.about.notes[-1] if part.about.notes else ""
    return last.removeprefix("filtered: ") if last.startswith("filtered: ") else None


def _notes(measured: Mapping[str, Measured]) -> None:
    """Print notes on missing calibrations."""
    unknown = [of.name for of in measured.values() if not of.calibrated]
    if unknown:
        more = f" and {counted(len(unknown) - 1, 'other')}" if len(unknown) > 1 else ""
        note(
            f"{unknown[0]}{more}: not calibrated, so how loud it was is not known; levels are in "
            "dBFS only (--calibrator or --full-scale gives a calibration)"
        )


_LEAST_AUDIBLE = -48.0
"""Level in the file of a barely audible sound [dBFS(A)]: speech at -23 LUFS is played like a talker
at 1 m (60 dB(A), ISO 9921), with the background noise of a quiet office, 35 dB(A)."""

_MAX_NAMES = 4
"""Number of sounds that a note names."""


def _note_faint(
    measured: Mapping[str, Measured], scales: Mapping[str, FullScale]
) -> dict[str, str]:
    """Print and return notes on sounds that are nearly inaudible in their files."""
    faint: dict[str, str] = {}
    for name, sound in measured.items():
        value = scales[name].value
        in_file = max(part.assessment.in_file(value).level_af_max for part in sound.parts)
        if math.isfinite(in_file) and in_file < _LEAST_AUDIBLE:
            in_air = max(part.assessment.levels.level_af_max for part in sound.parts)
            at = f"{in_air:.1f} dB(A) at the microphone, " * sound.calibrated
            faint[name] = f"{name} ({at}{in_file:.1f} dBFS(A) in the file)"
    if not faint:
        return {}
    scale = scales[next(iter(faint))]
    room = f", unless playback is calibrated to {scale.value:g} Pa" * (scale.gain == "calibrated")
    lead = (
        f"nearly inaudible (below {_LEAST_AUDIBLE:g} dBFS(A)) where the volume suits speech{room}"
    )
    more = f" and {len(faint) - _MAX_NAMES} more" * (len(faint) > _MAX_NAMES)
    note(f"{lead}: {', '.join([*faint.values()][:_MAX_NAMES])}{more}")
    return {name: f"{lead}: {words}" for name, words in faint.items()}
