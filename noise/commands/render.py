"""``bushing-noise render``: a recording or a condition into an audible WAV."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from models.errors import ParameterError
from noise.commands import options as opt
from noise.commands.operating import given_options, simulated_run
from noise.commands.targets import check_target
from noise.progress import note, say

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from models.recording import Recording

__all__ = ["configure", "run"]

_RATES = (44100, 48000)
_BITS = (16, 24, 32)


def configure(parser: ArgumentParser) -> None:
    """Declare description and options."""
    parser.description = (
        "Make the sound pressure of a recording, or of a run simulated for the purpose, audible: "
        "a WAV file for headphones or a listening room, without offset, faded in and out over "
        "10 ms, never clipped. A sidecar beside it keeps its calibration."
    )
    parser.epilog = (
        "examples: bushing-noise render run07.wav --out run07-audio.wav; "
        "bushing-noise render --speed 5 --out squawk.wav"
    )
    parser.add_argument(
        "recording", nargs="?", type=Path, metavar="INPUT", help="recording to make audible"
    )
    parser.add_argument(
        "--out", type=Path, required=True, metavar="AUDIO.wav", help="WAV file to write (required)"
    )
    parser.add_argument(
        "--rate",
        type=int,
        choices=_RATES,
        default=48000,
        help="sampling rate of the sound in Hz (default: 48000)",
    )
    parser.add_argument(
        "--bits",
        type=int,
        choices=_BITS,
        default=24,
        help="size of a sample in bit; 32 is floating point (default: 24)",
    )
    parser.add_argument(
        "--pascal-per-full-scale",
        type=opt.number(above=0.0),
        metavar="PA",
        help="sound pressure in Pa of a full-scale sample of the output, for a listening room "
        "that is calibrated to it (default: what puts the peak 3 dB below full scale)",
    )
    opt.add_full_scale(parser)
    opt.add_condition(parser)
    opt.add_seed(parser, "seed of the sensors' noise in a simulated run")


def run(options: Namespace) -> int:
    """Write the sound."""
    out = options.out
    if out.suffix.lower() != ".wav":
        out = out.with_name(out.name + ".wav")
    check_target(out)
    recording = _recording(options, out)
    from noise.audio import (
        QUIETEST_FULL_SCALE,
        audible,
        common_full_scale,
        least_full_scale,
        write_audio,
    )

    full_scale = options.pascal_per_full_scale
    if full_scale is not None and not recording.calibrated:
        raise ParameterError(
            f"--pascal-per-full-scale needs a calibrated input, and {recording.name} is not; "
            "--full-scale gives its calibration"
        )
    sound = audible(recording, options.rate)
    if full_scale is None:
        full_scale = common_full_scale([sound])
        if recording.calibrated:  # so that silence is not made loud
            full_scale = max(full_scale, QUIETEST_FULL_SCALE)
    elif full_scale < (least := least_full_scale(sound, options.bits)):
        raise ParameterError(
            f"--pascal-per-full-scale {full_scale:g} would clip; the smallest that does not is "
            f"{least:g}"
        )
    write_audio(
        out, sound, options.rate, full_scale=full_scale, bits=options.bits, recording=recording
    )
    if recording.calibrated:
        say(f"full scale is {full_scale:.4g} Pa")
    else:
        note(f"{recording.name} is not calibrated, so the level of the sound is not known")
    print(out)
    print(out.with_suffix(".json"))
    return 0


def _recording(options: Namespace, out: Path) -> Recording:
    given = given_options(options)
    if options.recording is None:
        if not given:
            raise ParameterError(
                "render needs a recording, or a condition such as --speed 5 to simulate"
            )
        if options.full_scale is not None:
            raise ParameterError("--full-scale is the calibration of a recording; none is given")
        # At the rate of the sound: the rig's own rate would cut the creak off at 15 kHz.
        return simulated_run(options, options.rate).recording
    if given:
        raise ParameterError(
            f"{given[0]} describes a run to simulate, but {options.recording} is already recorded; "
            "give one or the other"
        )
    if _same_recording(options.recording, out):
        raise ParameterError(f"--out {options.out} would overwrite the recording or its sidecar")
    from noise.recordings import read_recording

    say(f"reading {options.recording}")
    return read_recording(options.recording, full_scale=options.full_scale)


def _same_recording(one: Path, other: Path) -> bool:
    """Whether two files share their sidecar, or are one."""
    if one.parent.resolve() / one.stem == other.parent.resolve() / other.stem:
        return True
    return one.exists() and other.exists() and one.samefile(other)
