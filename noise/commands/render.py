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
    SEED,
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


_LOWEST, _NARROWEST = 1.0, 1.01  # Hz, and upper over lower end of a band: filters of it hold


def _band(text: str) -> tuple[float, float]:
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
    Option("--sound-quality"),
    *CALIBRATION,
    CONDITION,
    SEED,
)


def run(options: Namespace) -> int:
    """Write the sounds."""
    from noise.commands.render_sources import sources_of

    if options.sound_quality:
        from features.sound_quality import check_available

        check_available()
    if options.ab and options.match_loudness:
        raise ParameterError("--ab plays all parts at the same gain; leave --match-loudness out")
    sources = sources_of(options)
    if options.ab and len(sources) < 2:
        raise ParameterError("--ab puts two or more inputs behind one another; give a second one")
    folder = _folder(options, sources)
    check_target(options.out)
    files = _files(options, sources, folder)
    _keep_inputs(options.out, sources, files)
    return _rendered(options, files, folder)


class _File(NamedTuple):
    """One file to be: what it is called, and what is heard in it."""

    name: str
    target: Path
    sources: list[Source]


def _recordings(file: _File, band: tuple[float, float] | None) -> list[Recording]:
    from noise.audio.sound import heard

    made = [source.make(source.name) for source in file.sources]
    return made if band is None else [heard(one, band) for one in made]


def _folder(options: Namespace, sources: list[Source]) -> Path | None:
    """Where a set goes; None where there is one file."""
    named: Path = options.out
    several = len(sources) > 1 or any(Path(text).is_dir() for text in options.inputs)
    if options.ab or not (several or named.is_dir()):
        return None
    if named.suffix.lower() == ".wav":
        raise ParameterError(
            f"--out {named}: {counted(len(sources), 'sound')} are no single file; name a folder, "
            "or put them into one with --ab"
        )
    check_folder(named)
    return named


def _files(options: Namespace, sources: list[Source], folder: Path | None) -> list[_File]:
    from noise.audio.audio_file import audio_path

    if folder is not None:
        return [_File(one.name, audio_path(folder / one.name), [one]) for one in sources]
    target = audio_path(options.out)
    return [_File(target.stem if options.ab else sources[0].name, target, sources)]


def _keep_inputs(out: Path, sources: list[Source], written: list[_File]) -> None:
    """Refuse to write over a recording or its sidecar."""
    read = [source.path for source in sources if source.path is not None]
    stems = {path.resolve().with_suffix("") for path in read}
    for _, target, _ in written:
        same = target.exists() and any(map(target.samefile, read))
        if same or target.resolve().with_suffix("") in stems:
            raise ParameterError(f"--out {out} would overwrite the recording or its sidecar")


def _rendered(options: Namespace, files: list[_File], folder: Path | None) -> int:
    from noise.audio.render import COLUMNS, full_scales, measure, render
    from noise.base.tables import write_table

    measured: dict[str, Measured] = {}
    names: dict[str, list[str]] = {}
    refused: dict[str, str] = {}
    shape = {"rate": options.rate, "gap": options.gap, "fade": options.fade}
    for file in track(files, "measuring", unit="file"):
        try:
            made = _recordings(file, options.band)
            of = measure(
                made,
                **shape,
                quality=options.sound_quality,
                match=options.match_loudness,
            )
        except (BushingNoiseError, MemoryError) as error:
            if folder is None and not isinstance(error, RecordingError):
                raise
            refused[file.name] = str(error) or "needs more memory than there is"
            refuse(refused[file.name], file.name)
            continue
        measured[file.name] = of
        names[file.name] = [_noise_name(one) for one in made]
        for words in dict.fromkeys(filter(None, map(_filter_words, of.parts))):
            say(f"{file.name}: {words}")
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
        of, scale = measured[name], scales[name]
        written, summary = render(
            target,
            _recordings(files[index], options.band),
            of,
            scale,
            **shape,
            bits=options.bits,
            seed=(options.seed, index),
            note=faint.get(name),
        )
        file_name = target.name if folder is None else target.relative_to(folder).as_posix()
        rows += [
            {"file": file_name, **row, "filter": _filter_words(part), "note": faint.get(name)}
            for row, part in zip(written, of.parts, strict=True)
        ]
        worth = f"full scale is {scale.value:.4g} Pa; " * of.calibrated
        say(f"{name}: {worth}in the file {summary}")
        several = len(of.parts) > 1
        for part, noise in zip(of.parts, names[name], strict=True):
            lead = f"{name}: {part.about.name}" if several else name
            levels, *quality = part.assessment.words(scale.value)
            for line in (f"{noise}{levels}", *quality):
                say(f"{lead}: {line}")
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
        found = file_label(label_recording(recording, load_classifier()))
    except BushingNoiseError:  # too short or sampled too slowly to be labelled
        return ""
    pitch = "" if found.frequency is None else f"{found.frequency:.0f} Hz, "
    return f"{found.label}, {pitch}"


def _filter_words(part: Part) -> str | None:
    last = part.about.notes[-1] if part.about.notes else ""
    return last.removeprefix("filtered: ") if last.startswith("filtered: ") else None


def _notes(measured: Mapping[str, Measured]) -> None:
    """Say what the user should know of."""
    unknown = [of.name for of in measured.values() if not of.calibrated]
    if unknown:
        more = f" and {counted(len(unknown) - 1, 'other')}" if len(unknown) > 1 else ""
        note(
            f"{unknown[0]}{more}: not calibrated, so how loud it was is not known; levels are in "
            "dBFS only (--calibrator or --full-scale gives a calibration)"
        )
    for of in measured.values():
        for line in of.untold:
            note(line)


_LEAST_AUDIBLE = -48.0
"""A-weighted level in a file of what just stands out [dBFS(A)]: speech at -23 LUFS played as loud
as a talker at 1 m (60 dB(A), ISO 9921), over the background of a quiet office, 35 dB(A)."""

_MOST_NAMED = 4


def _note_faint(
    measured: Mapping[str, Measured], scales: Mapping[str, FullScale]
) -> dict[str, str]:
    """Say which sounds are nearly inaudible in their files."""
    faint: dict[str, str] = {}
    for name, of in measured.items():
        value = scales[name].value
        in_file = max(part.assessment.in_file(value).level_af_max for part in of.parts)
        if math.isfinite(in_file) and in_file < _LEAST_AUDIBLE:
            in_air = max(part.assessment.levels.level_af_max for part in of.parts)
            at = f"{in_air:.1f} dB(A) at the microphone, " * of.calibrated
            faint[name] = f"{name} ({at}{in_file:.1f} dBFS(A) in the file)"
    if not faint:
        return {}
    scale = scales[next(iter(faint))]
    room = f", unless playback is calibrated to {scale.value:g} Pa" * (scale.gain == "calibrated")
    lead = (
        f"nearly inaudible (below {_LEAST_AUDIBLE:g} dBFS(A)) where the volume suits speech{room}"
    )
    more = f" and {len(faint) - _MOST_NAMED} more" * (len(faint) > _MOST_NAMED)
    note(f"{lead}: {', '.join([*faint.values()][:_MOST_NAMED])}{more}")
    return {name: f"{lead}: {words}" for name, words in faint.items()}
