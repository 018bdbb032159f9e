"""Designs of a call: those that can be read, and why others cannot; nothing is simulated yet."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from models.errors import BushingNoiseError, ParameterError
from models.rig import Rig
from noise.screening.design.design import Design, load_design


def load_designs(
    designs: Sequence[str | Path | Design], change: Callable[[Rig], Rig] | None = None
) -> tuple[dict[str, Design], list[tuple[str, str]], list[tuple[str, Path]]]:
    """Read designs.

    Parameters
    ----------
    designs : sequence of str, Path or Design
        Design files, names of materials, or designs.
    change : callable, optional
        Makes another rig of that of each design.

    Returns
    -------
    dict of str to Design
        By their names; two of one name are told apart by a number.
    list of (str, str)
        Those that are refused, and why.
    list of (str, Path)
        Names of designs, and the files that they are as they stand in.

    Raises
    ------
    ParameterError
        All are refused.

    Examples
    --------
    >>> loaded, refused, files = load_designs(["PDMS", "PDMS", "cheese"])
    >>> list(loaded), [name for name, _ in refused], files
    (['PDMS', 'PDMS (2)'], ['cheese'], [])
    """
    loaded: dict[str, Design] = {}
    refused: list[tuple[str, str]] = []
    files: list[tuple[str, Path]] = []
    for one in designs:
        try:
            design = one if isinstance(one, Design) else load_design(one)
            if change is not None:
                design = replace(design, rig=change(design.rig))
        except BushingNoiseError as error:
            refused.append((one.name if isinstance(one, Design) else str(one), str(error)))
            continue
        design = _with_name_of_its_own(design, set(loaded))
        loaded[design.name] = design
        if change is None and not isinstance(one, Design) and Path(one).is_file():
            files.append((design.name, Path(one)))
    if not loaded:
        raise ParameterError(refused[0][1])
    return loaded, refused, files


def _with_name_of_its_own(design: Design, taken: set[str]) -> Design:
    """Two designs of one name are told apart by a number."""
    name, number = design.name, 2
    while name in taken:
        name, number = f"{design.name} ({number})", number + 1
    return replace(design, name=name)
