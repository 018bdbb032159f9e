"""``bushing-noise render``: recordings or conditions into audible WAV files."""

from __future__ import annotations

from argparse import ArgumentTypeError
from pathlib import Path
from typing import TYPE_CHECKING

from models.errors import BushingNoiseError, ParameterError, RecordingError
from noise.base.atomic import check_target
from noise.base.progress import counted, note, say, track
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
    seed,
    whole_number,
)

if TYPE_CHECKING:
    from argparse import Namespace

    from noise.audio.rendering import Survey
    from noise.batch.lines import Results
    from noise.commands.render_plans import Plan
    from noise.commands.render_sources import Source


_LOWEST, _NARROWEST = 1.0, 1.01  # Hz, and upper over lower end of a band: filters of it hold
_LONG_ENOUGH = 2.0  # s, to be judged by ear


def _band(text: str) -> tuple[float, float]:
    low, high = band(text)
    if low < _LOWEST or high < low * _NARROWEST:
        raise ArgumentTypeError(
            f"is {text!r}, expected a band that begins at {_LOWEST:g} Hz or above and is at least "
            f"{_NARROWEST - 1.0:.0%} wide"
        )
    return low, high


DESCRIPTION = (
    "Make the sound pressure of recordings, or of runs simulated for the purpose, audible: "
    "WAV files for headphones or a listening room, without offset, faded in and out, never "
    "clipped, not even between two samples. Several inputs make a set in a folder, at one "
    "gain, so that the louder one stays louder. A sidecar beside each keeps its calibration "
    "and its levels: overall, A-weighted, largest fast level, one-third octaves. Repeated "
    "strokes and run-ups are simulated for as long as --seconds says, never looped."
)

EPILOG = (
    "examples: bushing-noise render run07.wav --out run07-audio.wav; "
    "bushing-noise render --speed 0..10 --seconds 8 --out run-up.wav; "
    "bushing-noise render old.toml new.toml --speed 5 --seconds 4 --ab --out old-new.wav; "
    'bushing-noise render "--interference 0.279" "--interference 0.381" --speed 5 --out set'
)

OPTIONS = (
    Option("inputs INPUT", str, count="*").help(
        "recording, folder of recordings, rig file (RIG.toml) to simulate, or options of a "
        'condition to simulate in quotes, such as "--speed 5 --interference 0.381"; what the '
        "last two leave out is as the other options say"
    ),
    Option("--out AUDIO.wav|FOLDER", Path, required=True).help(
        "WAV file to write; for several sounds a folder, which gets a table levels.csv as well"
    ),
    Option("--ab").help("put the inputs behind one another into one file, at the same gain"),
    Option("--gap S", number(least=0.0, most=60.0), 0.5).help("silence between two of them in s"),
    Option("--repeats N", whole_number(1, most=20), 1).help(
        "simulate each run N times, with random numbers of its own, one behind the other; "
        "with --ab: A B A B ... (default: 1, at most 20)"
    ),
    Option("--rate 44100|48000", one_of(44100, 48000), 48000).help(
        "sampling rate of the sound in Hz"
    ),
    Option("--bits 16|24|32", one_of(16, 24, 32), 24).help(
        "size of a sample in bit; 16 is dithered, 32 is floating point"
    ),
    Option("--fade S", number(least=0.0, most=60.0), 0.010).help(
        "length of the fades in and out in s"
    ),
    OneOf(
        Option("--pascal-per-full-scale PA", number(above=0.0, most=1e9)).help(
            "sound pressure in Pa of a full-scale sample of the output, for a listening room "
            "that is calibrated to it (default: what puts the largest peak of all 3 dB below full "
            "scale)"
        ),
        Option("--match-loudness").help(
            "give each sound the same loudness instead (ITU-R BS.1770): -23 LUFS, or what its "
            "peaks allow below -1 dB true peak (EBU R 128)"
        ),
    ),
    Option("--band LOW..HIGH", _band).help(
        "listen to these frequencies in Hz alone, such as 200..2000; zero-phase, 6 dB down at "
        "the ends and 48 dB an octave beyond; levels are then those of the band, and how far they "
        "lie below the whole sound is told (default: all)"
    ),
    Option("--notch HZ", number(least=10.0, most=200e3), repeated=True).help(
        "take a tone of this frequency out, and what lies 3 % beside it; zero-phase; may be "
        "given several times (default: none)"
    ),
    Option("--sound-quality").help(
        "tell loudness (ISO 532-1), sharpness (DIN 45692), roughness and tonality as well; "
        "needs the extra sound-quality, and some seconds a second of sound; 10 minutes at most"
    ),
    *CALIBRATION,
    CONDITION,
    seed("seed of the sensors' noise in a simulated run, and of the dither"),
)


def run(options: Namespace) -> int:
    """Write the sounds."""
    from noise.batch.lines import kept_results
    from noise.commands.render_plans import measuring_identity
    from noise.commands.render_sources import sources_of

    if options.sound_quality:
        from features.sound_quality import check_available

        check_available()
    if options.ab and options.match_loudness:
        raise ParameterError("--ab plays all parts at the same gain; leave --match-loudness out")
    sources = sources_of(options)
    if options.ab and len(sources) * options.repeats < 2:
        raise ParameterError("--ab puts two or more inputs behind one another; give a second one")
    folder = _folder(options, sources)
    check_target(options.out)
    plans = _plans(options, sources, folder)
    _keep_inputs(options.out, sources, plans)
    table = None if folder is None else folder / "levels.csv"
    with kept_results(table, measuring_identity(options)) as kept:
        return _rendered(options, plans, folder, kept)


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


def _plans(options: Namespace, sources: list[Source], folder: Path | None) -> list[Plan]:
    from noise.audio.files import audio_path
    from noise.audio.filters import SoundFilter
    from noise.commands.render_plans import Plan

    through = SoundFilter(options.band, tuple(options.notch or ()))
    numbers = range(options.repeats)
    if folder is not None:
        return [
            Plan(one.name, audio_path(folder / one.name), tuple((one, n) for n in numbers), through)
            for one in sources
        ]
    target = audio_path(options.out)
    runs = tuple((source, number) for number in numbers for source in sources)
    return [Plan(target.stem if options.ab else sources[0].name, target, runs, through)]


def _keep_inputs(out: Path, sources: list[Source], plans: list[Plan]) -> None:
    """Refuse to write over a recording or its sidecar."""
    from noise.commands.render_sources import RecordedSource

    read = [source.path for source in sources if isinstance(source, RecordedSource)]
    stems = {path.parent.resolve() / path.stem for path in read}
    files = {(path.stat().st_dev, path.stat().st_ino) for path in read}
    for plan in plans:
        target = plan.target
        same = target.parent.resolve() / target.stem in stems
        if not same and target.exists():
            same = (target.stat().st_dev, target.stat().st_ino) in files
        if same:
            raise ParameterError(f"--out {out} would overwrite the recording or its sidecar")


def _rendered(
    options: Namespace, plans: list[Plan], folder: Path | None, kept: Results | None
) -> int:
    from noise.audio.rendering import COLUMNS, render
    from noise.base.tables import write_table
    from noise.commands.render_gain import faint_notes, full_scales

    surveys: dict[str, Survey] = {}
    refused: dict[str, str] = {}
    filters: dict[str, list[str]] = {}
    shape = {"rate": options.rate, "gap": options.gap, "fade": options.fade}
    for plan in track(plans, "measuring", unit="sound"):
        try:
            surveys[plan.name], notes = plan.surveyed(
                kept,
                **shape,
                quality=options.sound_quality,
                loudness=options.match_loudness,
            )
        except BushingNoiseError as error:
            if folder is None and not isinstance(error, RecordingError):
                raise
            refused[plan.name] = str(error)
            refuse(error, plan.name)
            continue
        if plan.through:
            filters[plan.name] = [one[-1].removeprefix("filtered: ") for one in notes]
            for words in dict.fromkeys(filters[plan.name]):
                say(f"{plan.name}: {words}")
    scales = full_scales(
        surveys, pascal=options.pascal_per_full_scale, matched=options.match_loudness
    )
    _notes(options, plans, surveys)
    faint, faint_of = faint_notes(surveys, scales, back_to_back=options.ab)
    if faint:
        note(faint)
    rows: list[dict[str, object]] = []
    for index, plan in enumerate(plans):
        if plan.name not in surveys:
            rows.append({"file": plan.target.name, "error": refused[plan.name]})
            continue
        survey_of, scale = surveys[plan.name], scales[plan.name]
        with plan.takes() as takes:
            written = render(
                plan.target,
                takes,
                survey_of,
                scale,
                **shape,
                bits=options.bits,
                seed=(options.seed, index),
                note=faint_of.get(plan.name),
            )
        name = plan.target.name if folder is None else plan.target.relative_to(folder).as_posix()
        told = filters.get(plan.name, [""] * len(written.rows))
        rows += [
            {"file": name, **row, "filter": words or None, "note": faint_of.get(plan.name)}
            for row, words in zip(written.rows, told, strict=True)
        ]
        _tell(plan, survey_of, scale.value, written.summary, alone=folder is None)
        print(plan.target)
        print(plan.target.with_suffix(".json"))
    if folder is not None:
        write_table(
            folder / "levels.csv",
            ("file", *COLUMNS, "filter", "note", "error"),
            rows,
        )
        print(folder / "levels.csv")
    return 1 if refused else 0


def _tell(plan: Plan, survey: Survey, full_scale: float, summary: str, *, alone: bool) -> None:
    if survey.calibrated:
        say(f"{plan.name}: full scale is {full_scale:.4g} Pa; in the file {summary}")
    else:
        say(f"{plan.name}: in the file {summary}")
    several = len(survey.assessments) > 1
    for part, assessment in zip(survey.parts, survey.assessments, strict=True):
        lead = f"{plan.name}: {part.name}" if several else plan.name
        for line in assessment.words(full_scale, bands=alone and not several):
            say(f"{lead}: {line}")


def _notes(options: Namespace, plans: list[Plan], surveys: dict[str, Survey]) -> None:
    """Say what the user should know of."""
    from noise.commands.render_sources import SimulatedSource

    unknown = [of.name for of in surveys.values() if not of.calibrated]
    if unknown:
        more = f" and {counted(len(unknown) - 1, 'other')}" if len(unknown) > 1 else ""
        note(
            f"{unknown[0]}{more}: not calibrated, so how loud it was is not known; levels are in "
            "dBFS only (--full-scale gives a calibration)"
        )
    for of in surveys.values():
        for line in of.untold:
            note(line)
    short = any(
        isinstance(source, SimulatedSource) and source.arguments["seconds"] < _LONG_ENOUGH
        for plan in plans
        for source, _ in plan.runs
    )
    if short and options.seconds is None:
        note("a sound of 2 to 10 s is easier to judge by ear; --seconds simulates for longer")
