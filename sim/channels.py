"""Channels as effects on the measurement see them: what each of them gets of an effect."""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.recording import REFERENCE_PRESSURE
from sim.parameters import Parameter

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import numpy as np
    from numpy.typing import NDArray

    from sim.effects.effect import Signals

__all__ = ["change_channels", "channel_level", "channel_shares"]


def channel_level(name: str, values: Mapping[str, float]) -> float:
    """Root mean square in a channel, in its unit; 0 where nothing is stated.

    Parameters
    ----------
    name : str
        Of the channel; ``torque_2`` is of the kind ``torque``.
    values : mapping of str to float
        ``pressure_level`` [dB re 20 uPa], ``acceleration``, ``torque`` and ``angle``.

    Examples
    --------
    >>> values = {"pressure_level": 94.0, "acceleration": 1.0, "torque": 0.1, "angle": 0.0}
    >>> round(channel_level("pressure_2", values), 2), channel_level("speed", values)
    (1.0, 0.0)
    """
    kind = name.partition("_")[0]
    if kind == "pressure":
        return REFERENCE_PRESSURE * float(10.0 ** (values["pressure_level"] / 20.0))
    return values[kind] if kind in ("acceleration", "torque", "angle") else 0.0


def channel_shares(what: str, low: float = -1.0, **shares: float) -> dict[str, Parameter]:
    """Declare the share of an effect's strength that each kind of channel gets.

    Parameters
    ----------
    what : str
        The strength in words.
    low : float
        Lowest share that may be set [-]; the highest is 1.
    **shares : float
        Default by kind of channel [-].

    Examples
    --------
    >>> channel_shares("delay", torque=0.5)["torque"].meaning
    'share of the delay on torques'
    """
    return {
        kind: Parameter(share, "", low, 1.0, f"share of the {what} on {kind}s")
        for kind, share in shares.items()
    }


def change_channels(
    signals: Signals,
    values: Mapping[str, float],
    strength: str,
    change: Callable[[NDArray[np.float64], float], NDArray[np.float64]],
) -> Signals:
    """Let an effect change each channel by its share of the strength.

    Parameters
    ----------
    signals : dict of str to ndarray, shape (n,)
        By channel, in its unit; ``torque_2`` is of the kind ``torque``.
    values : mapping of str to float
        The strength, and shares by kind of channel [-].
    strength : str
        Name of the strength.
    change : callable
        ``change(signal, strength)``; not called where the strength is zero.

    Returns
    -------
    dict of str to ndarray, shape (n,)
        In the channel's unit.

    Examples
    --------
    >>> import numpy as np
    >>> values = {"error": 0.5, "torque": 1.0}
    >>> signals = {"torque_2": np.ones(1), "angle": np.ones(1)}
    >>> change_channels(signals, values, "error", lambda signal, error: (1.0 + error) * signal)
    {'torque_2': array([1.5]), 'angle': array([1.])}
    """
    changed = {}
    for name, signal in signals.items():
        own = values[strength] * values.get(name.partition("_")[0], 0.0)
        changed[name] = signal if own == 0.0 else change(signal, own)
    return changed
