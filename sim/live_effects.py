"""Effects of drive and sensors on a run that goes on: each keeps what its next piece needs."""

from __future__ import annotations

from copy import deepcopy
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from sim.effects.effect import ActiveEffect, Effect, Memory, Signals

    Memories = dict[str, Memory]

__all__ = ["drive_piece", "sensors_piece"]


def drive_piece(
    even: NDArray[np.float64],
    n: int,
    rate: float,
    effects: Sequence[ActiveEffect],
    memories: Memories,
    seed: int,
) -> tuple[NDArray[np.float64], Memories]:
    """Speed of the shaft as effects of the drive make it [rad/s], and what they keep of it.

    Parameters
    ----------
    even : ndarray, shape (m,)
        Speed as it is set [rad/s].
    n : int
        Samples of this piece; those beyond are seen now, and come again.
    rate : float
        [Hz]
    effects : sequence of ActiveEffect
    memories : dict of str to dict
        What they kept of the piece before, by name; they stay as they are.
    seed : int
        Of those that scatter.

    Examples
    --------
    >>> from sim.effects import EFFECTS
    >>> uneven = EFFECTS["speed_fluctuation"].active({"frequency": 10.0})
    >>> first, kept = drive_piece(np.full(9, 5.0), 6, 100.0, [uneven], {}, 0)
    >>> second, _ = drive_piece(np.full(6, 5.0), 6, 100.0, [uneven], kept, 0)
    >>> bool(np.allclose(first[6:], second[:3]))
    True
    """
    kept: Memories = {}
    for active in effects:
        effect = active.effect
        if effect.drive_piece is None:
            continue
        memory = deepcopy(memories.get(effect.name)) or _begun(effect, seed)
        pieces = [effect.drive_piece(even[:n], rate, active.form, active.values, memory)]
        kept[effect.name] = memory
        if even.size > n:
            seen = deepcopy(memory)
            pieces.append(effect.drive_piece(even[n:], rate, active.form, active.values, seen))
        even = np.concatenate(pieces)
    return even, kept


def sensors_piece(
    signals: Signals,
    rate: float,
    effects: Sequence[ActiveEffect],
    memories: Memories,
    seed: int,
) -> tuple[Signals, Memories]:
    """Signals as effects on sensors change them, by channel, and what they keep of them.

    Parameters
    ----------
    signals : dict of str to ndarray, shape (n,)
    rate, effects, memories, seed
        As of `drive_piece`.

    Examples
    --------
    >>> from sim.effects import EFFECTS
    >>> hum = EFFECTS["mains_hum"].active({"form": "sine", "pressure_level": 94.0})
    >>> heard, kept = sensors_piece({"pressure": np.zeros(960)}, 48e3, [hum], {}, 0)
    >>> round(float(heard["pressure"].std()), 2), sorted(kept["mains_hum"])
    (1.0, ['pressure', 'rng'])
    """
    kept: Memories = {}
    for active in effects:
        effect = active.effect
        if effect.sensors_piece is None:
            continue
        memory = deepcopy(memories.get(effect.name)) or _begun(effect, seed)
        signals = effect.sensors_piece(signals, rate, active.form, active.values, memory)
        kept[effect.name] = memory
    return signals, kept


def _begun(effect: Effect, seed: int) -> Memory:
    """Return what an effect begins with; each has random numbers of its own."""
    return {"rng": np.random.default_rng([seed, *effect.name.encode()])}
