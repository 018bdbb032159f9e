"""``bushing-noise frf``: hammer hits into a frequency response function and its modes."""

from __future__ import annotations

import sys
from argparse import ArgumentTypeError, Namespace
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from models.errors import ParameterError, RecordingError
from noise.base.files import atomic, check_target
from noise.base.progress import counted, note, report, say, track
from noise.base.tables import check_table_path, write_table
from noise.commands.options import Option, band, number, refuse

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from features.modal.hammer import Hit
    from features.modal.modal_fit import Modes
    from models.transfer_functions.transfer_function import TransferFunction


_COHERENCE = 0.8
"""Coherence below which a line or a mode is not to be trusted [-]."""

_TRUNCATION = 0.02  # remaining response at the end of a hit, relative; peaks are that much too low


def _channel(text: str) -> str:
    """Parse the name of a channel."""
    from models.recording import Channel

    try:
        return Channel(text).name
    except ParameterError as error:
        raise ArgumentTypeError(f"is {text!r}: {error}") from None


OPTIONS = (
    Option("hits HIT", Path, count="+"),
    Option("--out FILE", Path),
    Option("--modes TABLE", Path),
    Option("--arm M", number(above=0.0, most=100.0)),
    Option("--response NAME", _channel),
    Option("--band LOW..HIGH", band),
)


def run(options: Namespace) -> int:
    """Estimate the response function, fit modes and write both."""
    _check(options)
    hits, unit, refused = _read(options)
    say(f"{counted(len(hits), 'hit')} averaged, {refused} refused")
    if not hits:
        return 1
    from features.modal.hammer import estimate_transfer_function, remaining_response

    remaining = remaining_response(hits)
    if remaining > _TRUNCATION:
        note(
            f"{100 * remaining:.3g} % of a response has not died away at its end (or is noise). "
            "Peaks are then too low and damping is wrong: record for longer"
        )
    transfer = estimate_transfer_function(
        hits,
        input_unit="N" if options.arm is None else "N m",
        output_unit=unit,
        name=f"response of {counted(len(hits), 'hit')}",
    )
    _note_coherence(transfer)
    modes = None
    if options.modes is not None:
        from features.modal.modal_fit import fit_modes
        from models.transfer_functions.transfer_function import trusted_band

        say("fitting modes")
        low, high = options.band or trusted_band(transfer)
        modes = fit_modes(
            transfer.frequencies, transfer.response,
            low=low, high=high, coherence=transfer.coherence,
        )  # fmt: skip
        modes = _trusted(modes, transfer, hits)
        count = counted(modes.frequency.size, "mode")
        say(f"{count} between {low:.5g} and {high:.5g} Hz")
    _write(options, transfer, modes)
    return 1 if refused else 0


def _check(options: Namespace) -> None:
    """Refuse outputs that cannot be written, before the work."""
    from models.transfer_functions.files import check_transfer_function_path

    if options.out is not None:
        check_transfer_function_path(options.out)
    check_target(options.out)
    check_table_path(options.modes)
    check_target(options.modes)
    if options.modes is None and options.band is not None:
        raise ParameterError("--band needs --modes")


def _read(options: Namespace) -> tuple[list[Hit], str, int]:
    """Return hits of equal length, the unit of the response, and the number of refused hits."""
    from features.modal.hammer import check_hit
    from noise.recordings.hits import find_hits, read_hit

    hits: list[Hit] = []
    first_unit, refused = "", 0
    for path in track(find_hits(options.hits), "reading", unit="hit"):
        try:
            hit, unit = read_hit(path, response=options.response, arm=options.arm)
            check_hit(hit)
            if hits and (hit.rate, unit) != (hits[0].rate, first_unit):
                raise RecordingError(
                    f"{path}: is sampled at {hit.rate:g} Hz, with a response in {unit}; "
                    f"{hits[0].name} at {hits[0].rate:g} Hz in {first_unit}"
                )
        except RecordingError as error:
            refuse(error)
            refused += 1
        else:
            first_unit = unit
            hits.append(hit)
    lengths = {hit.force.size for hit in hits}
    if len(lengths) > 1:
        n = min(lengths)
        note(f"hits of different lengths are cut to the shortest, {n} samples")
        hits = [replace(hit, force=hit.force[:n], response=hit.response[:n]) for hit in hits]
    return hits, first_unit, refused


def _note_coherence(transfer: TransferFunction) -> None:
    """Print how much of the response is not to be trusted."""
    if transfer.coherence is None:
        note("a single hit has no coherence; hit at least three times to see what can be trusted")
        return
    low = float((transfer.coherence[1:] < _COHERENCE).mean())
    note(f"coherence is below {_COHERENCE:g} in {low:.0%} of the lines, which cannot be trusted")


def _write(options: Namespace, transfer: TransferFunction, modes: Modes | None) -> None:
    """Write all outputs together, or none."""
    from models.transfer_functions.files import write_transfer_function, write_transfer_function_csv

    with ExitStack() as outputs:
        if options.out is not None:
            write_transfer_function(outputs.enter_context(atomic(options.out)), transfer)
        if modes is not None:
            table = _mode_table(modes, transfer)
            rows = (
                dict(zip(table, line, strict=True)) for line in zip(*table.values(), strict=True)
            )
            write_table(outputs.enter_context(atomic(options.modes)), list(table), rows)
    if options.out is None and options.modes is None:
        if sys.stdout is None:
            raise ParameterError("standard output is closed; name a file with --out")
        write_transfer_function_csv(sys.stdout, transfer)
    report(*filter(None, (options.out, options.modes)))


def _trusted(modes: Modes, transfer: TransferFunction, hits: list[Hit]) -> Modes:
    """Return the modes at which coherence and force are sufficient."""
    from features.modal.hammer import force_nulls

    coherent = ~(_coherence(modes, transfer) < _COHERENCE)  # the coherence of a single hit is NaN
    excited = ~force_nulls(hits, modes.frequency, modes.damping_ratio * modes.frequency)
    for trusted, reason in (
        (coherent, f"the coherence is below {_COHERENCE:g}"),
        (excited | ~coherent, "the force has almost no power"),
    ):
        if left_out := int((~trusted).sum()):
            note(f"{counted(left_out, 'mode')} left out, where {reason}")
    return modes.only(coherent & excited)


def _coherence(modes: Modes, transfer: TransferFunction) -> NDArray[np.float64]:
    """Return the median coherence in the half-power band of each mode, over three lines or more."""
    import numpy as np

    f, coherence = transfer.frequencies, transfer.coherence
    if coherence is None:
        return np.full(modes.frequency.size, np.nan)
    reach = np.maximum(modes.damping_ratio * modes.frequency, 1.5 * transfer.spacing)
    return np.array(
        [
            np.median(coherence[np.abs(f - middle) <= half])
            for middle, half in zip(modes.frequency, reach, strict=True)
        ]
    )


def _mode_table(modes: Modes, transfer: TransferFunction) -> dict[str, NDArray[Any]]:
    """Return the columns of the table of modes."""
    import numpy as np

    return {
        "frequency_hz": modes.frequency,
        "damping_ratio": modes.damping_ratio,
        "residue_real": modes.residues.real,
        "residue_imag": modes.residues.imag,
        "peak": np.abs(modes.residues) / (2 * np.pi * modes.frequency * modes.damping_ratio),
        "coherence": _coherence(modes, transfer),
        "orders": modes.orders,
    }
