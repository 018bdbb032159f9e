"""What a case is about, drawn before anything is run: its class, its rig, its conditions.

The rig and the conditions come from streams that do not know the class, so that neither names,
lengths, rates nor operating points can give it away. Classes come in blocks, which keeps
their shares exact, and causes in rounds, which keeps them even. What kind of bench it is stands in
`benches`.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from .benches import KINDS, Bench, draw_bench, place_of
from .effects import CAUSES, DEVELOPMENT, STRANGERS, Form, forms_of
from .laws import LAWS
from .rig import FIXED, Parameters

__all__ = [
    "BLOCKS", "CLASSES", "OFFSET_KEYS", "Condition", "Design", "draw_design", "stream",
]  # fmt: skip

CLASSES = (
    ["none"] * 3 + ["parameters"] * 3 + ["one"] * 8 + ["pair"] * 3 + ["triple"] + ["stranger"] * 2
)
"""A block of classes: a share of 15, 15, 40, 15, 5 and 10 %."""

_OF_A_KIND = (
    ["none"] * 20 + ["parameters"] * 6 + ["one"] * 16 + ["pair"] * 8 + ["stranger"] * 6
)  # fmt: skip
_SEALED_OF_A_KIND = (
    ["none"] * 80 + ["parameters"] * 25 + ["one"] * 84 + ["pair"] * 44 + ["triple"] * 14
    + ["stranger"] * 28
)  # fmt: skip
BLOCKS = {
    "shares": CLASSES, "kind": _OF_A_KIND, "sealed kind": _SEALED_OF_A_KIND,
}  # fmt: skip
"""One block of a kind is what development draws of a kind of bench; one sealed block leaves 75
nulls, 60 singles, 30 pairs and 20 strangers where a quarter is too weak to see."""

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
_TORQUE_PER_K, _STIFFNESS_PER_K = -0.005, -0.003


def stream(seed: int, kept_for: str, kind: str, *where: int) -> np.random.Generator:
    """A generator of its own for each purpose, so that none disturbs another."""
    which = int(kept_for == DEVELOPMENT) + 2 * place_of(kind)
    return np.random.default_rng([seed, which, *where])


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
    bench: Bench = field(default_factory=Bench)

    def stream(self, *where: int) -> np.random.Generator:
        """A generator of this case for a purpose."""
        return stream(self.seed, self.kept_for, self.bench.kind, self.index, *where)

    def nominal(self, condition: Condition) -> Parameters:
        """What the rig file says of a condition."""
        stiffness, critical, kinetic = self.fits[condition.interference_mm]
        return Parameters(
            self.inertias[0], self.inertias[1], stiffness, condition.support,
            self.damping[condition.support], critical, kinetic,
        )  # fmt: skip

    def true(self, condition: Condition, recording: int) -> Parameters:
        """What the rig was in one recording: offsets of the case, scatter of the recording."""
        rng = self.stream(4, recording)
        nominal = self.nominal(condition)
        factor = dict.fromkeys(OFFSET_KEYS, 1.0) | self.offsets
        scatter = np.exp(0.02 * rng.standard_normal(5))
        small = np.exp(0.004 * rng.standard_normal(2))
        weaker = 1.0 + _TORQUE_PER_K * self.bench.warmer
        kinetic = nominal.kinetic_torque * factor["kinetic_torque"] * weaker
        drop = nominal.critical_torque * factor["critical_torque"] * weaker - kinetic
        fixed = nominal.support_stiffness < 0.0
        return replace(
            nominal,
            elastomer_stiffness=nominal.elastomer_stiffness
            * factor["elastomer_stiffness"] * scatter[0]
            * (1.0 + _STIFFNESS_PER_K * self.bench.warmer),
            kinetic_torque=kinetic * scatter[1],
            critical_torque=kinetic * scatter[1] + drop * scatter[2],
            damping=nominal.damping * factor["damping"] * scatter[3],
            elastomer_inertia=nominal.elastomer_inertia * factor["elastomer_inertia"] * scatter[4],
            support_stiffness=FIXED if fixed else nominal.support_stiffness * small[0],
            clamp_inertia=nominal.clamp_inertia * small[1],
        )  # fmt: skip


def _conditions(rng: np.random.Generator, bench: Bench) -> tuple[Condition, ...]:
    repeats = 2 if KINDS[bench.kind].repeats else 0
    different = int(rng.integers(4, 10)) - repeats
    supports = [float(x) for x in rng.choice(list(_SUPPORTS), rng.integers(1, 3), replace=False)]
    fits = [float(x) for x in rng.choice(list(_FITS), rng.integers(1, 4), replace=False)]
    found: list[Condition] = []
    while len(found) < different:
        fit = fits[int(rng.integers(len(fits)))]
        fastest = _FITS[fit][3] if rng.random() < 0.9 else 10.0
        speed = round(float(np.exp(rng.uniform(np.log(0.6), np.log(fastest)))), 1)
        support = _support(supports[int(rng.integers(len(supports)))], bench)
        condition = Condition(float(f"{speed * bench.pace:.3g}"), fit, support)
        if condition not in found:
            found.append(condition)
    both = found + [found[i] for i in rng.choice(different, repeats, replace=False)]
    return tuple(both[i] for i in rng.permutation(len(both)))


def _support(support: float, bench: Bench) -> float:
    """Of a bench of another size; a bolted clamp stays so."""
    return support if support == FIXED else float(round(support * bench.sizes["support"]))


def _what(
    seed: int, index: int, kept_for: str, classes: list[str], bench: Bench
) -> tuple[str, list[str]]:
    """Class and effects of a case."""

    def chance(*where: int) -> np.random.Generator:
        return stream(seed, kept_for, bench.kind, *where)

    block, place = divmod(index, len(classes))
    kinds = [classes[i] for i in chance(block, 1).permutation(len(classes))]
    kind = kinds[place]
    before = classes.count(kind) * block + kinds[:place].count(kind)
    offered = CAUSES
    if kind == "stranger":
        offered = tuple(name for name in STRANGERS if forms_of(name, kept_for))
    if kind in ("one", "stranger"):
        turn, which = divmod(before, len(offered))
        order = chance(turn, 2, CLASSES.index(kind)).permutation(len(offered))
        after = [offered[order[(which + i) % len(offered)]] for i in range(len(offered))]
        return kind, [next(name for name in after if name not in bench.without)]
    offered = tuple(name for name in offered if name not in bench.without)
    count = {"pair": 2, "triple": 3}.get(kind, 0)
    chosen = chance(index, 3).choice(len(offered), count, replace=False)
    return kind, [offered[i] for i in sorted(chosen)]


def _fits(
    wide: np.ndarray, bench: Bench
) -> tuple[dict[float, tuple[float, float, float]], dict[float, float]]:
    """Stiffness and torques by fit, damping by support; a larger rig is damped in proportion."""
    size, steeper = bench.sizes, LAWS[bench.law.name].drop
    fits = {}
    for i, (fit, (k, critical, kinetic, _)) in enumerate(_FITS.items()):
        strong = wide[3 + i] * size["torque"]
        most = critical if steeper == 1.0 else kinetic + steeper * (critical - kinetic)
        fits[fit] = (k * wide[i] * size["elastomer_stiffness"], most * strong, kinetic * strong)
    inertia = float(np.sqrt(size["elastomer_inertia"] * size["clamp_inertia"]))
    lossy = float(np.sqrt(size["elastomer_stiffness"] * inertia))
    damping = {
        _support(kb, bench): c * wide[6 + i] * lossy for i, (kb, c) in enumerate(_SUPPORTS.items())
    }
    return fits, damping


def draw_design(
    seed: int, index: int, kept_for: str, block: str = "shares", kind: str = "quiet"
) -> Design:
    """Draw case `index` (from 0) of a set; `block` names how many of each class there are."""
    bench = draw_bench(kind, stream(seed, kept_for, kind, index, 11))
    rng = stream(seed, kept_for, kind, index, 0)
    wide = np.exp(0.08 * rng.standard_normal(16))
    fits, damping = _fits(wide, bench)
    conditions = _conditions(rng, bench)
    rate, seconds = int(rng.choice(KINDS[kind].rates)), float(rng.choice(KINDS[kind].lengths))
    rate_error = float(1e-4 * rng.standard_normal())
    case, names = _what(seed, index, kept_for, BLOCKS[block], bench)
    secret = stream(seed, kept_for, kind, index, 5)
    forms = []
    for name in names:
        offered = bench.forms(name, kept_for)
        strength = float(np.exp(secret.uniform(np.log(WEAKEST), 0.0)))
        forms.append((offered[int(secret.integers(len(offered)))], strength))
    offsets = {}
    if case == "parameters":
        sign = float(secret.choice([-1.0, 1.0]))
        for key in secret.choice(OFFSET_KEYS, secret.integers(1, 3), replace=False):
            offsets[str(key)] = float(1.0 + sign * secret.uniform(0.08, 0.20))
    size = bench.sizes
    inertias = (
        1.0 / 65000.0 * wide[10] * size["elastomer_inertia"],
        1.0 / 1200.0 * wide[11] * size["clamp_inertia"],
    )
    return Design(
        seed, index, kept_for, case, fits, damping, inertias, conditions, rate, rate_error, seconds,
        tuple(forms), offsets, block, bench,
    )  # fmt: skip
