"""Recordings that laws are fitted to, and where a search begins with each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from noise.identification.excerpts import Excerpts, excerpts_of
from sim.bushing import LumpedBushing

if TYPE_CHECKING:
    from noise.identification.bushing_fit import Known
    from noise.identification.measured import Measured
    from noise.identification.outcome import Seen


_LEAST_DROP = 0.05
"""What the critical torque exceeds the kinetic one by where a search begins, at least [-];
assumed."""


@dataclass(frozen=True, eq=False)
class Subject:
    """A recording that laws are fitted to.

    Parameters
    ----------
    measured : Measured
    excerpts : Excerpts
    start : ndarray, shape (7,)
        Where a search begins: logarithms of `noise.identification.law_model.LOCAL` [-].
    """

    measured: Measured
    excerpts: Excerpts
    start: NDArray[np.float64]

    @property
    def interference(self) -> float:
        """Fit [m]."""
        return self.measured.condition.interference

    @property
    def support(self) -> float:
        """Stiffness of the support [Nm/rad]."""
        return self.measured.condition.support_stiffness

    def with_some(self, n: int) -> Subject:
        """Return it with `n` excerpts at most."""
        return replace(self, excerpts=self.excerpts.some(n))


def subjects_of(seen: Sequence[Seen], known: Known) -> list[Subject]:
    """Make subjects of the recordings that slip, each begun at the median of its interference.

    Parameters
    ----------
    seen : sequence of Seen
    known : Known

    Returns
    -------
    list of Subject
    """
    slipping = [one for one in seen if one.levels.slips]
    subjects = []
    for one in slipping:
        c, kinetic = one.measured.condition, one.levels.kinetic
        alike = [o for o in slipping if o.measured.condition.interference == c.interference]
        stiffness = float(np.median([o.fit.bushing.elastomer_stiffness for o in alike]))
        damping = float(np.median([o.fit.damping for o in alike]))
        drop = float(np.median([o.levels.critical / o.levels.kinetic - 1.0 for o in alike]))
        bushing = LumpedBushing(
            known.elastomer_inertia, known.clamp_inertia, stiffness, c.support_stiffness,
            known.damping_share * damping, (1.0 - known.damping_share) * damping,
        )  # fmt: skip
        excerpts = excerpts_of(one.measured, bushing)
        if excerpts is not None:
            start = np.log([
                stiffness, kinetic, max(drop, _LEAST_DROP) * kinetic, damping,
                known.elastomer_inertia, known.clamp_inertia, known.damping_share,
            ])  # fmt: skip
            subjects.append(Subject(one.measured, excerpts, start))
    return subjects
