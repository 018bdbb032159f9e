"""Kinds of bench: what is unlike ours on somebody else's, though nothing is the matter.

A `Kind` is one entry of `KINDS`; a new one goes to the end, since its place is part of the seeds.
`draw_bench` draws one bench of a kind by a stream that does not know the class of a case.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from .effects import CAUSES, DEVELOPMENT, FOREIGN, forms_of
from .effects.listed import Listed, draw_listed
from .laws import CONSTANT, Law, draw_law

if TYPE_CHECKING:
    from collections.abc import Mapping

    from .effects import Form

__all__ = [
    "BITS", "CHANNELS", "KINDS", "NOISE", "SIZES", "Bench", "Kind", "draw_bench", "place_of",
]  # fmt: skip

CHANNELS = {"torque": "N m", "acceleration": "m/s^2", "pressure": "Pa", "angle": "rad"}
NOISE = {"torque": 0.005, "acceleration": 0.03, "pressure": 1.0e-3, "angle": 1e-4}
"""Of a quiet bench, in the channels' units."""

RANGES = {"torque": 102.5, "acceleration": 976.75, "pressure": 28.86, "angle": 12.375}
"""Of the thesis's converter, +-1.25 V (Appendices B to E), in the channels' units."""

BITS = 12
"""Of the thesis's converter."""

SIZES = ("elastomer_inertia", "clamp_inertia", "elastomer_stiffness", "torque", "support")
"""What a bench of another size has more or less of, each by itself."""


@dataclass(frozen=True)
class Kind:
    """A kind of bench: ranges and choices from which each is drawn.

    `noise`: factors of `NOISE`; `converter`: share of benches whose samples have steps, of `BITS`
    bits and up to four more; `stated`: share whose rig file states its sensors; `sizes`: the
    largest factor from the thesis's; `wrong_speed`: largest relative error of what sidecars say;
    `warmer`: largest error of the temperature [K]; `responses`: how the hammer test was;
    `foreign`: whether effects have the forms of `effects.foreign`.
    """

    rates: tuple[int, ...] = (25_600, 30_000, 32_000, 44_100, 48_000)
    lengths: tuple[float, ...] = (0.4, 0.5, 0.6, 0.8, 1.0)
    noise: tuple[float, float] = (1.0, 1.0)
    converter: float = 0.0
    stated: float = 0.0
    starts: tuple[str, ...] = ("settled",)
    laws: tuple[str, ...] = ("constant",)
    sizes: float = 1.0
    listed: tuple[int, int] = (0, 0)
    repeats: bool = True
    wrong_speed: float = 0.0
    warmer: float = 0.0
    responses: tuple[str, ...] = ("good",)
    foreign: bool = False


_STARTS = ("rest", "run_up", "swing")
KINDS = {
    "quiet": Kind(),
    "sensors": Kind(noise=(0.3, 4.0), converter=0.67, stated=0.5),
    "starts": Kind(starts=(*_STARTS, "settled")),
    "records": Kind(
        rates=(12_000, 16_000, 25_600, 51_200, 96_000), lengths=(0.3, 0.5, 0.8, 1.3, 2.1, 3.3, 5.0)
    ),
    "laws": Kind(laws=("constant", "stribeck", "rate_and_state", "memory", "bristle")),
    "sizes": Kind(sizes=3.0),
    "listed": Kind(listed=(1, 2)),
    "single": Kind(repeats=False),
    "conditions": Kind(wrong_speed=0.03, warmer=5.0),
    "responses": Kind(responses=("poor", "poor", "none")),
    "together": Kind(noise=(1.0, 4.0), converter=0.67, stated=0.5, starts=_STARTS),
    "noisy": Kind(noise=(3.0, 30.0), converter=0.5, starts=("settled", "rest")),
    "foreign_forms": Kind(foreign=True),
}
"""All kinds by name; `together` is what the worst figures so far came from."""


@dataclass(frozen=True)
class Bench:
    """One bench: noise and steps by channel, sizes as factors, and what sidecars do not say."""

    kind: str = "quiet"
    noise: Mapping[str, float] = field(default_factory=lambda: dict(NOISE))
    bits: Mapping[str, int] = field(default_factory=dict)
    stated: bool = False
    law: Law = CONSTANT
    sizes: Mapping[str, float] = field(default_factory=lambda: dict.fromkeys(SIZES, 1.0))
    listed: tuple[Listed, ...] = ()
    speed_factor: float = 1.0
    warmer: float = 0.0
    responses: str = "good"

    @property
    def channels(self) -> tuple[str, ...]:
        """What is recorded: without responses nobody could say what the structure should do."""
        return ("torque", "angle") if self.responses == "none" else tuple(CHANNELS)

    @property
    def pace(self) -> float:
        """By how much such a rig's speeds differ, so that it does the same at them."""
        s = self.sizes
        return s["torque"] / float(np.sqrt(s["elastomer_stiffness"] * s["elastomer_inertia"]))

    @property
    def without(self) -> tuple[str, ...]:
        """Effects that would be nothing here, or that the rig file lists already."""
        creeping = () if self.law.name == "constant" else ("partial_slip",)
        unseen = () if "acceleration" in self.channels else (
            "beam_modes", "slip_pulse", "plate_modes", "room_reflections",
        )  # fmt: skip
        own = [c for c in CAUSES if KINDS[self.kind].foreign and not self.forms(c, DEVELOPMENT)]
        return (*creeping, *unseen, *own, *(one.effect for one in self.listed))

    def forms(self, effect: str, kept_for: str) -> list[Form]:
        """Forms that an effect may have here; strangers are the same everywhere."""
        foreign = KINDS[self.kind].foreign and effect in CAUSES
        return forms_of(effect, FOREIGN[kept_for] if foreign else kept_for)

    def range_of(self, channel: str) -> float:
        """Largest value of a channel's converter: the thesis's, doubled for stronger rigs."""
        size = self.sizes["torque"] if channel == "torque" else 1.0
        return RANGES[channel] * 2.0 ** max(0.0, np.ceil(np.log2(size)))

    def step_of(self, channel: str) -> float:
        """One bit of a channel; 0 where samples have no steps."""
        bits = self.bits.get(channel)
        return 0.0 if bits is None else 2.0 * self.range_of(channel) / 2.0**bits


def place_of(kind: str) -> int:
    """Return the place of a kind among all, a part of its seeds."""
    return list(KINDS).index(kind)


def draw_bench(name: str, rng: np.random.Generator) -> Bench:
    """Draw a bench of a kind."""
    kind = KINDS[name]
    loud = np.exp(rng.uniform(*np.log(kind.noise), len(CHANNELS)))
    steps = bool(rng.random() < kind.converter)
    bits = int(rng.integers(BITS, BITS + 5))
    stated = bool(rng.random() < kind.stated)
    law = draw_law(str(rng.choice(kind.laws)), rng)
    sizes = np.exp(rng.uniform(-1.0, 1.0, len(SIZES)) * np.log(kind.sizes))
    listed = draw_listed(int(rng.integers(kind.listed[0], kind.listed[1] + 1)), rng)
    return Bench(
        name,
        {channel: NOISE[channel] * float(x) for channel, x in zip(CHANNELS, loud, strict=True)},
        dict.fromkeys(CHANNELS, bits) if steps else {},
        stated,
        law,
        dict(zip(SIZES, map(float, sizes), strict=True)),
        listed,
        1.0 + kind.wrong_speed * float(rng.uniform(-1.0, 1.0)),
        kind.warmer * float(rng.uniform(-1.0, 1.0)),
        str(rng.choice(kind.responses)),
    )
