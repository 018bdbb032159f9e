"""Modulation over time, estimated: of the shaft's speed, and of a channel's gain.

A modulation that was recorded is played again in the simulation: one of those of the recordings,
from any moment on if it has no beginning, as a speed's, from the start if it has one, as a drift's.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from noise.diagnosis.fit.forms.form import Form, amount_form
from noise.diagnosis.gap.signature import NAMES
from sim.effects.effect import Signals, Values

if TYPE_CHECKING:
    from noise.diagnosis.fit.forms.form import Compared


_BLOCK = 0.03
"""In which a gain is one number [s]; assumed."""

_FINE = 4096
"""Steps of a gain's modulation."""

_LEFT_BY_JUMP = 0.25
"""Of a modulation's variance, less than which a single jump must leave to be taken for one;
assumed."""

_ENDS = 0.02
"""Left out of a speed at each end, where its differentiation has none to lean on [s]; assumed."""


def speed_forms(compared: Sequence[Compared]) -> list[Form]:
    """Play the shaft's own modulations again."""
    modulations = [c.modulation[_inside(c)] for c in compared if c.modulation is not None]
    if not modulations:
        return []
    rate = compared[0].rate

    def drive(
        speed: NDArray[np.float64],
        at: float,
        _form: str,
        values: Values,
        rng: np.random.Generator,
    ) -> NDArray[np.float64]:
        modulation = modulations[int(rng.integers(len(modulations)))]
        there_and_back = np.concatenate([modulation, modulation[::-1]])
        when = rng.random() * there_and_back.size + np.arange(speed.size) * (rate / at)
        played = np.interp(when, np.arange(there_and_back.size), there_and_back,
                           period=there_and_back.size)  # fmt: skip
        return np.asarray(speed * np.maximum(1.0 + values["amount"] * played, 0.0))

    return [amount_form("speed_fluctuation", "recorded", drive=drive)]


def _inside(c: Compared) -> slice:
    cut = round(_ENDS * c.rate)
    return slice(cut, -cut)


def gain_forms(compared: Sequence[Compared]) -> list[Form]:
    """Play gains again.

    The torque's is that of its mean over the rig file's; those of acceleration and sound are over
    what the torque lets expect, which has the torque's own gain in it if that is wrong.
    """
    having = [c for c in compared if "torque" in c.measured]
    if not having:
        return []
    torque = [_jumping(_torque_gain(c)) for c in having]
    forms = [_gain_form({"torque": torque})]
    kinds = [k for k in ("acceleration", "pressure") if all(k in c.expected for c in having)]
    over = {
        k: [_jumping(_gain(c.expected[k], c.measured[k], c.rate)) for c in having] for k in kinds
    }
    for kind in kinds:
        both = [g * t for g, t in zip(over[kind], torque, strict=True)]
        forms.append(_gain_form({kind: over[kind]}))
        forms.append(_gain_form({"torque": torque, kind: both}))
    if len(kinds) > 1:
        forms.append(_gain_form(over))
    return forms


def _jumping(gain: NDArray[np.float64]) -> NDArray[np.float64]:
    """Course of a gain in fine steps: with one sharp jump if that is what it does, or gradual."""
    best, jump = float(np.sum((gain - gain.mean()) ** 2)) * _LEFT_BY_JUMP, None
    for k in range(1, gain.size):
        before, after = gain[:k].mean(), gain[k:].mean()
        left = float(np.sum((gain[:k] - before) ** 2) + np.sum((gain[k:] - after) ** 2))
        if left < best:
            best, jump = left, (k / gain.size, float(before), float(after))
    time = (np.arange(_FINE) + 0.5) / _FINE
    if jump is not None:
        return np.where(time < jump[0], jump[1], jump[2])
    return np.interp(time, (np.arange(gain.size) + 0.5) / gain.size, gain)


def _gain_form(gains: Mapping[str, list[NDArray[np.float64]]]) -> Form:
    count = len(next(iter(gains.values())))

    def sensors(
        signals: Signals, _rate: float, _form: str, values: Values, rng: np.random.Generator
    ) -> Signals:
        which, read = int(rng.integers(count)), dict(signals)
        for kind, modulations in gains.items():
            gain, x = modulations[which], signals[kind]
            place = np.linspace(0.0, gain.size - 1.0, x.size).round().astype(np.int64)
            modulation = gain[place]
            read[kind] = x * np.maximum(1.0 + values["amount"] * (modulation - 1.0), 0.02)
        return read

    name = f"recorded of {' and '.join(gains)}"
    return amount_form("gain_error", name, highest=2.0, sensors=sensors)


def _torque_gain(c: Compared) -> NDArray[np.float64]:
    torque = c.measured["torque"]
    n = max(2, round(torque.size / c.rate / _BLOCK))
    means = [abs(float(part.mean())) for part in np.array_split(torque, n)]
    mean = float(np.exp(c.nominal[NAMES.index("cycle_mean")]))
    return np.asarray(np.clip(np.array(means) / mean, 0.05, 20.0))


def _gain(
    expected: NDArray[np.float64], measured: NDArray[np.float64], rate: float
) -> NDArray[np.float64]:
    """Gain in each block, by what is common to both signals."""
    n = max(2, round(expected.size / rate / _BLOCK))
    edges = np.linspace(0, expected.size, n + 1).astype(int)
    gains = np.ones(n)
    for k, (a, b) in enumerate(zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True)):
        x, y = expected[a:b] - expected[a:b].mean(), measured[a:b] - measured[a:b].mean()
        gains[k] = np.clip(float(y @ y) / (float(x @ x) + 1e-30), 1e-2, 1e2) ** 0.5
    gains[: n // 8 + 1] = gains[n // 8 + 1]  # what rings on from before is not expected
    return np.convolve(np.pad(gains, 1, mode="edge"), np.full(3, 1.0 / 3.0), mode="valid")
