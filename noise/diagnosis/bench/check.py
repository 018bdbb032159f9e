"""Is it this rig at all? What is wrong with a bench's units, signs, channels or conditions.

Asked before anything else: the posterior of causes has learned with right benches, and names a
cause for whatever else it is shown. What is found is told, and no cause is named.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from models.errors import BushingNoiseError
from models.recording import Recording
from models.rig import Rig
from noise.diagnosis.bench.channels import (
    backwards,
    swapped_channels,
    turned_channels,
    wrong_units,
)
from noise.diagnosis.bench.conditions import shuffled_conditions, wrong_speed
from noise.diagnosis.bench.faults import dead_channels
from noise.diagnosis.bench.levels import levels_of
from noise.diagnosis.bench.materials import another_level, another_material
from noise.diagnosis.bench.silent import noise_findings
from noise.diagnosis.simulated.transfer_functions import TransferFunctionCache
from sim.effects.effect import Effect

if TYPE_CHECKING:
    from noise.diagnosis.case import Case


_ANY_RIG = 3.0
"""Times that the torque of a rig may differ from another's of its kind [-]; assumed."""


def bench_findings(case: Case, library: Mapping[str, Effect] | None = None) -> tuple[str, ...]:
    """Say what of a case cannot be of its rig.

    Parameters
    ----------
    case : Case
    library : mapping of str to Effect, optional
        Effects that the rig's can be found among.

    Returns
    -------
    tuple of str
        One line each; empty where nothing is.
    """
    if dead := tuple(dead_channels(case.names, case.recordings)):
        return dead
    if case.misplaced:
        return (case.misplaced,)
    cache = TransferFunctionCache(case.rig, library)
    levels = [levels_of(recording, case.rig, cache) for recording in case.recordings]
    if swapped := swapped_channels(case.recordings, case.rig, levels):
        return (swapped,)
    if reversed_ := backwards(levels):
        return (reversed_,)
    if shuffled := shuffled_conditions(case, levels):
        return (shuffled,)
    found = [
        *turned_channels(levels), *wrong_units(levels), *noise_findings(case, levels),
        wrong_speed(levels),
    ]  # fmt: skip
    if found := [text for text in found if text]:
        return tuple(found)
    level = another_level(levels)
    other = level or another_material(case, cache, library)
    return (other,) if other else ()


def unit_findings(recordings: Sequence[Recording], rig: Rig) -> tuple[str, ...]:
    """Say which channels are in another unit, of a rig of which only the kind is known.

    Parameters
    ----------
    recordings : sequence of Recording
        With known conditions.
    rig : Rig
        One of its kind, as that which an identification starts from.

    Returns
    -------
    tuple of str
        One line each; empty where none is, and where the rig cannot tell.
    """
    cache = TransferFunctionCache(rig)
    try:
        levels = [levels_of(recording, rig, cache) for recording in recordings]
    except BushingNoiseError:  # a support that this rig has not
        return ()
    return tuple(text for text in wrong_units(levels, alike=_ANY_RIG) if " looks like " in text)
