"""What a case is about, drawn before anything is run: its class, its rig, its conditions.

The rig and the conditions come from streams that do not know the class, so that neither names,
lengths, rates nor operating points can give it away. Classes come in blocks of twenty, which keeps
their shares exact, and causes in rounds, which keeps them even.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .effects import CAUSES, DEVELOPMENT, STRANGERS, Form, forms_of
from .rig import FIXED, Parameters

__all__ = ["BLOCKS", "CLASSES", "OFFSET_KEYS", "Condition", "Design", "draw_design", "stream"]

CLASSES = (
    ["none"] * 3 + ["parameters"] * 3 + ["one"] * 8 + ["pair"] * 3 + ["triple"] + ["stranger"] * 2
)
"""A block of classes: a share of 15, 15, 40, 15, 5 and 10 %."""

_QUOTAS = (
    ["none"] * 15 + ["parameters"] * 5 + ["one"] * 42 + ["pair"] * 5 + ["triple"] * 3
    + ["stranger"] * 5
)  # fmt: skip
BLOCKS = {"shares": CLASSES, "quotas": _QUOTAS}
"""Twenty blocks of quotas, 1500 cases, have 300 nulls, each cause 40 times and 100 strangers; by
shares that takes 2100."""

OFFSET_KEYS = (
    "elastomer_stiffness", "critical_torque", "kinetic_torque", "damping", "elastomer_inertia",
)  # fmt: skip

WEAKEST = 0.01
"""Least strength of an effect; 1 is strong."""
_FITS = {
    0.178: (430.0, 5.35, 4.0, 3.0),
    0.279: (665.0, 10.7, 8.0, 4.5),
    0.381: (1011.0, 27.0, 20.0, 8.0),
}
_SUPPORTS = {2214.0: 0.105, 3745.0: 0.085, FIXED: 0.085}
_RATES = (25_600, 30_000, 32_000, 44_100, 48_000)
_LENGTHS = (0.4, 0.5, 0.6, 0.8, 1.0)


def stream(seed: int, kept_for: str, *where: int) -> np.random.Generator:
    """A generator of its own for each purpose, so that none disturbs another."""
    return np.random.default_rng([seed, int(kept_for == DEVELOPMENT), *where])


@dataclass(frozen=True)
class Condition:
    """What a sidecar says of a recording, as asked for."""

    speed: float
    interference_mm: float
    support: float


@dataclass(frozen=True)
class Design:
    """A case before it is run; `offsets` are shared by all its recordings."""

    seed: int
    index: int
    kept_for: str
    kind: str
    fits: dict[float, tuple[float, float, float]]
    damping: dict[float, float]
    inertias: tuple[float, float]
    conditions: tuple[Condition, ...]
    rate: int
    rate_error: float
    seconds: float
    forms: tuple[tuple[Form, float], ...]
    offsets: dict[str, float]
    block: str = "shares"

    def nominal(self, condition: Condition) -> Parameters:
        """What the rig file says of a condition."""
        stiffness, critical, kinetic = self.fits[condition.interference_mm]
        return Parameters(
            self.inertias[0], self.inertias[1], stiffness, condition.support,
            self.damping[condition.support], critical, kinetic,
        )  # fmt: skip

    def true(self, condition: Condition, recording: int) -> Parameters:
        """What the rig was in one recording: offsets of the case, scatter of the recording."""
        rng = stream(self.seed, self.kept_for, self.index, 4, recording)
        nominal = self.nominal(condition)
        factor = dict.fromkeys(OFFSET_KEYS, 1.0) | self.offsets
        scatter = np.exp(0.02 * rng.standard_normal(5))
        small = np.exp(0.004 * rng.standard_normal(2))
        kinetic = nominal.kinetic_torque * factor["kinetic_torque"]
        drop = nominal.critical_torque * factor["critical_torque"] - kinetic
        fixed = nominal.support_stiffness < 0.0
        return replace(
            nominal,
            elastomer_stiffness=nominal.elastomer_stiffness
            * factor["elastomer_stiffness"] * scatter[0],
            kinetic_torque=kinetic * scatter[1],
            critical_torque=kinetic * scatter[1] + drop * scatter[2],
            damping=nominal.damping * factor["damping"] * scatter[3],
            elastomer_inertia=nominal.elastomer_inertia * factor["elastomer_inertia"] * scatter[4],
            support_stiffness=FIXED if fixed else nominal.support_stiffness * small[0],
            clamp_inertia=nominal.clamp_inertia * small[1],
        )  # fmt: skip


def _conditions(rng: np.random.Generator) -> tuple[Condition, ...]:
    different = int(rng.integers(4, 10)) - 2
    supports = [float(x) for x in rng.choice(list(_SUPPORTS), rng.integers(1, 3), replace=False)]
    fits = [float(x) for x in rng.choice(list(_FITS), rng.integers(1, 4), replace=False)]
    found: list[Condition] = []
    while len(found) < different:
        fit = fits[int(rng.integers(len(fits)))]
        fastest = _FITS[fit][3] if rng.random() < 0.9 else 10.0
        speed = round(float(np.exp(rng.uniform(np.log(0.6), np.log(fastest)))), 1)
        condition = Condition(speed, fit, supports[int(rng.integers(len(supports)))])
        if condition not in found:
            found.append(condition)
    both = found + [found[i] for i in rng.choice(different, 2, replace=False)]
    return tuple(both[i] for i in rng.permutation(len(both)))


def _what(seed: int, index: int, kept_for: str, classes: list[str]) -> tuple[str, list[str]]:
    """Class and effects of a case."""
    block, place = divmod(index, len(classes))
    kinds = [classes[i] for i in stream(seed, kept_for, block, 1).permutation(len(classes))]
    kind = kinds[place]
    before = classes.count(kind) * block + kinds[:place].count(kind)
    offered = CAUSES
    if kind == "stranger":
        offered = tuple(name for name in STRANGERS if forms_of(name, kept_for))
    if kind in ("one", "stranger"):
        turn, which = divmod(before, len(offered))
        order = stream(seed, kept_for, turn, 2, CLASSES.index(kind)).permutation(len(offered))
        return kind, [offered[order[which]]]
    count = {"pair": 2, "triple": 3}.get(kind, 0)
    chosen = stream(seed, kept_for, index, 3).choice(len(offered), count, replace=False)
    return kind, [offered[i] for i in sorted(chosen)]


def draw_design(seed: int, index: int, kept_for: str, block: str = "shares") -> Design:
    """Draw case `index` (from 0) of a set; `block` names how many of each class there are."""
    rng = stream(seed, kept_for, index, 0)
    wide = np.exp(0.08 * rng.standard_normal(16))
    fits = {
        fit: (k * wide[i], critical * wide[3 + i], kinetic * wide[3 + i])
        for i, (fit, (k, critical, kinetic, _)) in enumerate(_FITS.items())
    }
    damping = {kb: c * wide[6 + i] for i, (kb, c) in enumerate(_SUPPORTS.items())}
    conditions = _conditions(rng)
    rate, seconds = int(rng.choice(_RATES)), float(rng.choice(_LENGTHS))
    rate_error = float(1e-4 * rng.standard_normal())
    kind, names = _what(seed, index, kept_for, BLOCKS[block])
    secret = stream(seed, kept_for, index, 5)
    forms = []
    for name in names:
        offered = forms_of(name, kept_for)
        strength = float(np.exp(secret.uniform(np.log(WEAKEST), 0.0)))
        forms.append((offered[int(secret.integers(len(offered)))], strength))
    offsets = {}
    if kind == "parameters":
        sign = float(secret.choice([-1.0, 1.0]))
        for key in secret.choice(OFFSET_KEYS, secret.integers(1, 3), replace=False):
            offsets[str(key)] = float(1.0 + sign * secret.uniform(0.08, 0.20))
    return Design(
        seed, index, kept_for, kind, fits, damping,
        (1.0 / 65000.0 * wide[10], 1.0 / 1200.0 * wide[11]),
        conditions, rate, rate_error, seconds, tuple(forms), offsets, block,
    )  # fmt: skip
