"""Effects of drive and sensors on a run in blocks: each keeps what its next block needs."""

from __future__ import annotations

from copy import deepcopy
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sim.effects.effect import ActiveEffect, Memory, Signals

    Memories = dict[str, Memory]

__all__ = ["begun", "drive_block", "sensors_block"]


def begun(effects: Sequence[ActiveEffect], seed: int) -> Memories:
    """Return the memory, by name, that each effect begins with; each has its own random numbers."""
    names = [active.effect.name for active in effects if active.effect.in_blocks]
    return {name: {"rng": np.random.default_rng([seed, *name.encode()])} for name in names}


def drive_block(
    even: NDArray[np.float64],
    n: int,
    rate: float,
    effects: Sequence[ActiveEffect],
    memories: Memories,
) -> tuple[NDArray[np.float64], Memories]:
    """Speed of the shaft over a block as effects make it [rad/s], and what they keep of it.

    Parameters
    ----------
    even : ndarray, shape (m,)
        Speed as it is set [rad/s].
    n : int
        Samples of this block; those beyond are seen now, and come again.
    rate : float
        [Hz]
    effects : sequence of ActiveEffect
    memories : dict of str to dict
        What they kept of the block before, by name; they stay as they are.

    Examples
    --------
    >>> from sim.effects import EFFECTS
    >>> uneven = [EFFECTS["speed_fluctuation"].active({"frequency": 10.0})]
    >>> start = begun(uneven, 0)
    >>> first, kept = drive_block(np.full(9, 5.0), 6, 100.0, uneven, start)
    >>> second, _ = drive_block(np.full(6, 5.0), 6, 100.0, uneven, kept)
    >>> bool(np.allclose(first[6:], second[:3]))
    True
    """
    kept = deepcopy(memories)
    for active in effects:
        if active.effect.drive is None:
            continue
        memory = kept.get(active.effect.name, {})
        blocks = [active.driven(even[:n], rate, memory)]
        if even.size > n:
            blocks.append(active.driven(even[n:], rate, deepcopy(memory)))
        even = np.concatenate(blocks)
    return even, kept


def sensors_block(
    signals: Signals, rate: float, effects: Sequence[ActiveEffect], memories: Memories
) -> tuple[Signals, Memories]:
    """Signals of a block as effects on sensors change them, and what these keep of it.

    Parameters
    ----------
    signals : dict of str to ndarray, shape (n,)
    rate, effects, memories
        As of `drive_block`.

    Examples
    --------
    >>> from sim.effects import EFFECTS
    >>> hum = [EFFECTS["mains_hum"].active({"form": "sine", "pressure_level": 94.0})]
    >>> start = begun(hum, 0)
    >>> read, kept = sensors_block({"pressure": np.zeros(960)}, 48e3, hum, start)
    >>> round(float(read["pressure"].std()), 2), sorted(kept["mains_hum"])
    (1.0, ['pressure', 'rng'])
    """
    kept = deepcopy(memories)
    for active in effects:
        signals = active.sensed(signals, rate, kept.get(active.effect.name, {}))
    return signals, kept
