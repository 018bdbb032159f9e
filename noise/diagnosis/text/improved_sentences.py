"""The improved rig in words: what it has, how far it closes the gap, and what to call next."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from noise.diagnosis.improved_file import own_effects
from noise.diagnosis.text.found import parameter_name
from noise.diagnosis.text.words import cause_of, joined, number

if TYPE_CHECKING:
    from noise.diagnosis.improvement import Improvement


def improved_sentence(improvement: Improvement) -> str:
    """Say what an improved rig has and what it closes.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from noise.diagnosis.improvement import Improvement
    >>> found = Improvement(load_material_rig("PDMS"), {"damping": 1.03}, (), (),
    ...                     {"damping": 0.02}, (),
    ...                     ("run01.wav",), ("run02.wav",), 2.4, 1.1)
    >>> improved_sentence(found)
    'With damping 3.0 % higher the gap falls from 2.4 to 1.1 floors on held-out recordings.'
    """
    parts = [cause_of(spec.name).name for spec in improvement.effects]
    parts += [f"{cause_of(name).name} in its responses" for name in improvement.in_responses]
    parts += [
        f"{parameter_name(name)} {abs(100.0 * (factor - 1.0)):.1f} % "
        f"{'higher' if factor > 1.0 else 'lower'}"
        for name, factor in improvement.factors.items()
    ]
    unseen = set(improvement.held_out) - set(improvement.fitted_to)
    return (
        f"With {joined(parts)} the gap falls from {number(improvement.gap_before, '.2g')} to "
        f"{number(improvement.gap_after, '.2g')} floors on "
        f"{'held-out recordings' if unseen else 'the recording that it was fitted to'}."
    )


def improved_commands(
    improvement: Improvement, file: Path | str, data: Sequence[Path], effects: Path | None
) -> list[str]:
    """Return what to call next with a file of the improved rig.

    Parameters
    ----------
    improvement : Improvement
    file : path-like
    data : sequence of Path
        Recordings that it was diagnosed from.
    effects : Path, optional
        File of the user's own effects.

    Examples
    --------
    >>> from pathlib import Path
    >>> from models.rig_file import load_material_rig
    >>> from noise.diagnosis.improvement import Improvement
    >>> found = Improvement(load_material_rig("PDMS"), {"damping": 1.03}, (), (), {}, (), (), (),
    ...                     2.4, 1.1)
    >>> improved_commands(found, "out/improved.toml", [Path("recordings")], None)[0]
    'bushing-noise diagnose recordings --rig out/improved.toml'
    """
    import shlex

    own = own_effects(improvement)
    needed = ["--effects", str(effects)] if own and effects is not None else []
    recordings = [str(path) for path in data]
    calls = [["diagnose", *recordings, "--rig", str(file), *needed]]
    if not own:
        calls.append(["screen", str(file)])
    return [f"bushing-noise {shlex.join(call)}" for call in calls]
