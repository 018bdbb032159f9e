"""``improved.toml``, the rig file that closes a gap, and its description."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING

from models.change import multiplied
from models.errors import ParameterError
from models.rig_file import changed_rig_text, read_toml
from noise.diagnosis.words import cause_of, joined, number, parameter_name
from sim.effects import EFFECTS

if TYPE_CHECKING:
    from noise.diagnosis.outcome import Improvement


def improved_sentence(improvement: Improvement) -> str:
    """Return the changes of an improved rig and the gap that it leaves.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from noise.diagnosis.outcome import Improvement
    >>> found = Improvement(load_material_rig("PDMS"), {"damping": 1.03}, (),
    ...                     {"damping": 0.02}, (),
    ...                     ("run01.wav",), ("run02.wav",), 2.4, 1.1)
    >>> improved_sentence(found)
    'With damping 3.0 % higher the gap falls from 2.4 to 1.1 on held-out recordings; 1 is what
      repeats differ by.'
    """
    parts = [cause_of(spec.name).name for spec in improvement.effects]
    parts += [
        f"{parameter_name(name)} {abs(100.0 * (factor - 1.0)):.1f} % "
        f"{'higher' if factor > 1.0 else 'lower'}"
        for name, factor in improvement.factors.items()
    ]
    unseen = set(improvement.held_out) - set(improvement.fitted_to)
    return (
        f"With {joined(parts)} the gap falls from {number(improvement.gap_before, '.2g')} to "
        f"{number(improvement.gap_after, '.2g')} on "
        f"{'held-out recordings' if unseen else 'the recording that it was fitted to'}; 1 is what "
        "repeats differ by."
    )


NAME = "improved.toml"


def improved_text(
    improvement: Improvement,
    base: str,
    changes: Mapping[str, str | float] | None = None,
) -> str:
    """Return the rig file of an improved rig.

    Parameters
    ----------
    improvement : Improvement
    base : str
        Diagnosed rig, as in ``base``.
    changes : mapping of str to str or float, optional
        Changes of that file for the diagnosis, as in ``[change]`` [unit of the key].

    Returns
    -------
    str

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from noise.diagnosis.outcome import Improvement
    >>> found = Improvement(load_material_rig("PDMS"), {"damping": 1.03}, (),
    ...                     {"damping": 0.02}, (),
    ...                     ("run01.wav",), ("run02.wav",), 2.4, 1.1)
    >>> print(improved_text(found, "PDMS").partition("base")[2])
     = "PDMS"
    effects = []
    <BLANKLINE>
    [change]
    damping = "x1.03"
    <BLANKLINE>
    [tolerances]
    damping = 0.02
    <BLANKLINE>
    """
    return changed_rig_text(
        base,
        multiplied(improvement.rig, changes or {}, improvement.factors),
        improvement.rig.effects,
        {name: float(f"{spread:.2g}") for name, spread in improvement.spread.items()},
        _head(improvement),
    )


def _head(improvement: Improvement) -> list[str]:
    unseen = set(improvement.held_out) - set(improvement.fitted_to)
    where = f"On {', '.join(improvement.held_out)}, which this fit did not use,"
    paragraphs = [
        f"Improved by a diagnosis. Fitted to {', '.join(improvement.fitted_to)}.",
        f"{where if unseen else 'On what it was fitted to'} the gap fell from "
        f"{improvement.gap_before:.2g} to {improvement.gap_after:.2g}; 1 is that of repeats.",
        "[tolerances] has the relative standard deviation to which each number is known, for this "
        "fit and these forms of effects. It is no scatter of built parts.",
        "Do not trust it at speeds, interferences or supports beyond those recorded, or for the "
        "name of the cause: another effect may do the same here.",
    ]
    if improvement.undetermined:
        paragraphs.append(f"Hardly determined: {', '.join(improvement.undetermined)}.")
    if own := [spec.name for spec in improvement.rig.effects if spec.name not in EFFECTS]:
        paragraphs.append(f"It needs --effects FILE.py with {', '.join(own)}.")
    return [line for paragraph in paragraphs for line in wrap(paragraph, 96)]


def check_base(rig: Path, folder: Path) -> None:
    """Refuse a rig file that the improved one would overwrite.

    Parameters
    ----------
    rig : Path
        Rig file that is diagnosed.
    folder : Path
        Output folder.

    Raises
    ------
    ParameterError
        It, or a file that it is based on, is ``improved.toml`` in this folder.
    """
    target, path = (folder / NAME).resolve(), rig.resolve()
    checked: set[Path] = set()
    while path.is_file() and path not in checked:
        if path == target:
            raise ParameterError(
                f"--out {folder}: would write {NAME} over the rig file that --rig {rig} needs; "
                "name another folder"
            )
        checked.add(path)
        base = read_toml(path, f"rig file {path}").get("base")
        path = (path.parent / str(base)).resolve() if base else path
