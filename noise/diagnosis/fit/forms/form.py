"""One further form of an effect, as a fit tries it.

The simulator's own forms have parameters with names; a further one has a way to be made of a few
numbers. Both are told of by a `LawSpec` whose ``form`` names which it is.

Recordings beside what their own torque should have made of them: what forms are estimated from.

A torque that was measured is sent through the transfer functions of the rig file, so that nothing
that the contact does stands between; the shaft's own modulation is taken from its angle.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.condition import known_condition
from models.errors import ParameterError
from models.rig import LawSpec
from models.transfer_functions.transfer_function import TransferFunction
from noise.diagnosis.evidence.angle_summary import shaft_speed
from noise.diagnosis.simulated.transfer_functions import predict
from sim.effects import EFFECTS
from sim.effects.effect import ActiveEffect, Effect
from sim.parameters import Parameter

if TYPE_CHECKING:
    from noise.diagnosis.fit.case_comparison import CaseComparison


@dataclass(frozen=True, eq=False)
class Compared:
    """A recording.

    Parameters
    ----------
    rate : float
        [Hz]
    free : bool
        Whether the clamp stands on beams, rather than on the baseplate itself.
    measured : dict of str to ndarray, shape (n,)
        By kind of channel; those that were recorded [unit of the channel].
    expected : dict of str to ndarray, shape (n,)
        Of acceleration and pressure, by the measured torque [unit of the channel].
    transfer_functions : mapping of str to TransferFunction
        That it was sent through.
    modulation : ndarray, shape (n,), optional
        Shaft speed over its mean, less 1 [-].
    signature, nominal, scale : ndarray, shape (n_values,)
        Of the recording; middle of the simulated repeats, and what they scatter by As of
        `noise.diagnosis.gap.signature`.
    """

    rate: float
    free: bool
    measured: dict[str, NDArray[np.float64]]
    expected: dict[str, NDArray[np.float64]]
    transfer_functions: Mapping[str, TransferFunction]
    modulation: NDArray[np.float64] | None
    signature: NDArray[np.float64]
    nominal: NDArray[np.float64]
    scale: NDArray[np.float64]


def compared(comparison: CaseComparison, chosen: Sequence[int]) -> list[Compared]:
    """Compare recordings of a comparison.

    Parameters
    ----------
    comparison : CaseComparison
    chosen : sequence of int

    Returns
    -------
    list of Compared
        One a recording.
    """
    return [_one(comparison, i) for i in chosen]


def _one(comparison: CaseComparison, i: int) -> Compared:
    recording = comparison.recordings[i]
    c, rate = known_condition(recording.condition), recording.rate
    measured = {
        kind: recording.samples[row].astype(np.float64)
        for kind in ("torque", "acceleration", "pressure", "angle")
        if (row := recording.first(kind)) is not None
    }
    expected: dict[str, NDArray[np.float64]] = {}
    transfers: Mapping[str, TransferFunction] = {}
    if "torque" in measured:
        transfers = comparison.runs.transfer_functions.whole(recording)
        expected = {
            kind: predict(measured["torque"], rate, transfers[kind])
            for kind in ("acceleration", "pressure")
            if kind in measured
        }
    modulation = None
    if "angle" in measured:
        speed = shaft_speed(measured.pop("angle"), rate)
        modulation = np.asarray(speed / (speed.mean() or 1.0) - 1.0)
    reference = comparison.references[i]
    return Compared(
        rate, not math.isinf(c.support_stiffness), measured, expected, transfers, modulation,
        comparison.signatures[i], reference.mean, reference.scale,
    )  # fmt: skip


_AMOUNT = Parameter(1.0, "", 0.0, 4.0, "over what was estimated")


@dataclass(frozen=True, eq=False)
class Form:
    """A further form of an effect.

    Parameters
    ----------
    effect, name : str
        Of the effect; its own, which no other form of the effect may have.
    start : mapping of str to float
        What it is made of, as a fit begins with it [unit of the number].
    highest : mapping of str to float
        How far each may rise [unit of the number].
    make : callable
        ``make(values)``: the effect with these numbers.
    tried : tuple of float
        Of the first of these numbers, what a fit looks at; by default where it begins [unit of the
        number].
    """

    effect: str
    name: str
    start: Mapping[str, float]
    highest: Mapping[str, float]
    make: Callable[[Mapping[str, float]], Effect]
    tried: tuple[float, ...] = ()

    def active(self, given: Mapping[str, float | str]) -> ActiveEffect:
        """Return the effect with these numbers, the others as a fit begins with them.

        Raises
        ------
        ParameterError
            A number that it is not made of.
        """
        values = dict(self.start)
        for key, value in given.items():
            if key == "form":
                continue
            if key not in values or isinstance(value, str):
                raise ParameterError(
                    f"form {self.name!r} of {self.effect!r} has no {key!r}; it has "
                    f"{', '.join(values)}"
                )
            values[key] = value
        return replace(self.make(values).active({}), form=self.name, values=values)

    def specs(self) -> list[LawSpec]:
        """Return what a fit looks at, as models name it."""
        first = next(iter(self.start))
        return [self.spec(**{first: value}) for value in self.tried or (self.start[first],)]

    def spec(self, **values: float) -> LawSpec:
        """Return it as models name it."""
        return LawSpec(self.effect, {"form": self.name, **self.start, **values})


def amount_form(
    effect: str,
    name: str,
    *,
    highest: float = 4.0,
    tried: tuple[float, ...] = (),
    **acting: object,
) -> Form:
    """Make a form of one number, ``amount``: how much there is of what was estimated.

    Parameters
    ----------
    effect, name : str
        As of `Form`.
    highest : float
        How far the amount may rise [-].
    tried : tuple of float
        Amounts that a fit looks at [-]; by default 1.
    **acting : callable
        Hooks, as of `sim.effects.effect.Effect`; they find the amount among their values.

    Examples
    --------
    >>> amount_form("clipping", "hard", tried=(0.05, 0.2)).start
    {'amount': 0.05}
    """

    def make(values: Mapping[str, float]) -> Effect:
        given = {"amount": replace(_AMOUNT, default=values["amount"])}
        stage = EFFECTS[effect].stage
        return Effect(effect, stage, ("estimated",), given, "amount", **acting)  # type: ignore[arg-type]

    return Form(effect, name, {"amount": (*tried, 1.0)[0]}, {"amount": highest}, make, tried)
