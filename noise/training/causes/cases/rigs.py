"""Random rigs, benches and conditions, drawn independently of the cause.

A bench is the equipment with which a rig is recorded. Three of ten are quiet and of the thesis's
size. The others depart from that in several ways at once, over wider ranges than those of known
benches. Rigs may have friction laws of their own, with parameters near those of the shipped
materials. On a rig of another size the parameters of a law scale by their units: angles with torque
over stiffness, times with the period of the bushing, speeds with the ratio of both. So the rig
behaves alike. A recording may include the start of the shaft: from rest, as a run-up, or with a
decaying swing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from models.condition import FIXED, KnownCondition
from models.rig import Fit, LawSpec, Rig
from models.rig_file import load_material_rig
from models.sensors import Sensor, Sensors
from noise.base import log_uniform, packaged_toml
from noise.base.arrays import Array, Rng
from noise.diagnosis.cases.draws import draw_numbers, drawn_effect
from noise.training.draws import picked
from sim.acquisition import THESIS_CONVERTER, Acquisition
from sim.effects import EFFECTS, constant_version
from sim.friction import friction_law
from sim.motion import simulate_motion
from sim.plan import DIAGNOSIS, REGIME_RATE
from sim.shaft import ConstantSpeed, LoggedSpeed

if TYPE_CHECKING:
    Course = Callable[[Array], Array]


_LATEST = 0.55
"""Share of a recording after which the speed of the shaft is constant to 0.1 % [-]."""


def draw_start(
    name: str, speed: float, seconds: float, settling: float, rng: Rng
) -> tuple[LoggedSpeed, float]:
    """Draw a course of speed.

    Parameters
    ----------
    name : str
        Key of `STARTS`.
    speed : float
        Final speed [rad/s].
    seconds, settling : float
        Length of the recording, and time before it in which a shaft that does not start from rest
        turns [s].
    rng : numpy.random.Generator

    Returns
    -------
    shaft : LoggedSpeed
    before : float
        Time for which it turns before the recording begins [s].

    Examples
    --------
    >>> shaft, before = draw_start("rest", 2.0, 0.5, 0.35, np.random.default_rng(0))
    >>> shaft.speed(np.array([0.0, 0.5])), before
    (array([0., 2.]), 0.0)
    """
    course = STARTS[name](seconds, rng)
    time = np.arange(0.0, seconds + 1e-3, 5e-4)
    factor = course(time)
    before = 0.0 if factor[0] == 0.0 else settling
    return LoggedSpeed(time + before, speed * factor), before


def _rest(seconds: float, rng: Rng) -> Course:
    ramp = log_uniform(3e-3, 0.25 * seconds, rng)
    power = float(rng.uniform(0.6, 1.6))
    return lambda t: np.minimum(t / ramp, 1.0) ** power


def _run_up(seconds: float, rng: Rng) -> Course:
    low, ramp = float(rng.uniform(0.2, 0.85)), float(rng.uniform(0.1, _LATEST)) * seconds
    smooth = bool(rng.random() < 0.5)

    def course(t: Array) -> Array:
        x = np.minimum(t / ramp, 1.0)
        return low + (1.0 - low) * (x * x * (3.0 - 2.0 * x) if smooth else x)

    return course


def _swing(seconds: float, rng: Rng) -> Course:
    depth, frequency = float(rng.uniform(0.08, 0.5)), log_uniform(3.0, 25.0, rng)
    decay = float(rng.uniform(0.02, _LATEST / math.log(1e3))) * seconds
    phase = float(rng.uniform(0.0, 2.0 * math.pi))
    return lambda t: 1.0 + depth * np.exp(-t / decay) * np.sin(2 * np.pi * frequency * t + phase)


STARTS: Mapping[str, Callable[[float, Rng], Course]] = {
    "rest": _rest,
    "run_up": _run_up,
    "swing": _swing,
}
"""Courses of speed: functions of the length of the recording [s] and a generator that return the
speed over the final speed as a function of time."""


TABLE = packaged_toml("noise.training.causes.cases", "cases.toml")

MATERIALS: Mapping[str, float] = TABLE["materials"]
"""Shipped materials with friction laws of their own, and the share of each [-]."""

OWN_LAWS = {name: float(row["share"]) for name, row in TABLE["laws"].items()} | {**MATERIALS}
"""Laws, or materials with a law, and the share of each [-]."""


def draw_law(name: str, rng: Rng) -> LawSpec:
    """Draw the parameters of a law for a rig of the thesis's size.

    Examples
    --------
    >>> import numpy as np
    >>> sorted(draw_law("lugre", np.random.default_rng(0)).parameters)[-2:]
    ['stribeck_speed', 'viscous_share_per_speed']
    """
    ranges = {key: spec for key, spec in TABLE["laws"][name].items() if key != "share"}
    return LawSpec(name, draw_numbers(ranges, rng))


def scaled_law(law: LawSpec, *, angle: float, time: float, torque: float) -> LawSpec:
    """Scale a law to a rig of another size.

    Parameters
    ----------
    law : LawSpec
    angle, time, torque : float
        Factors on angles, on the period of the bushing, on torques [-].

    Returns
    -------
    LawSpec
        With all its parameters, limited to their ranges.

    Examples
    --------
    >>> stribeck = LawSpec("lugre", {"stribeck_speed": 1.0})
    >>> scaled_law(stribeck, angle=3.0, time=0.5, torque=2.0).parameters["stribeck_speed"]
    6.0
    """
    factors: Mapping[str, float] = {
        "1/rad": 1.0 / angle, "rad": angle, "s": time, "rad/s": angle / time,
        "s/rad": time / angle, "rad/Nm": angle / torque,
    }  # fmt: skip
    declared = friction_law(law.name).parameters
    given = {name: float(law.parameters.get(name, p.default)) for name, p in declared.items()}
    return LawSpec(
        law.name,
        {
            name: min(max(value * factors.get(declared[name].unit, 1.0), declared[name].low),
                      declared[name].high)
            for name, value in given.items()
        },
    )  # fmt: skip


NOISE_DRAWN = (0.7, 1.6)
"""Range of the noise of a quiet bench's sensors over that of `sim.acquisition` [-]."""

SIZES = ("elastomer_inertia", "clamp_inertia", "elastomer_stiffness", "torque", "support")
"""Quantities in which a bench of another size differs, each independently."""

_RATES = (25_600, 30_000, 32_000, 44_100, 48_000, 51_200)
"""Sampling rates of recordings of usual length [Hz]."""


@dataclass(frozen=True)
class Bench:
    """Equipment and size of a rig.

    Parameters
    ----------
    departures : tuple of str
        Departures from a quiet bench: ``laws``, or keys of `DEPARTURES`.
    rate, seconds : float
        Sampling rate and length of its recordings [Hz], [s].
    noise : mapping of str to float
        Standard deviation of white noise by channel [unit of the channel].
    bits : int
        Resolution of a converter; 0 without quantisation.
    ranges : float
        Range of that converter over the thesis's [-].
    stated : bool
        Whether the rig file states noise and converter.
    law : str
        Key of `OWN_LAWS`; empty for the constant law.
    sizes : mapping of str to float
        Factors on the thesis's rig, by `SIZES` [-].
    listed : tuple of LawSpec
        Effects that the rig file lists besides those of its material.
    repeats : bool
        Whether two conditions are recorded twice.
    wrong_speed : float
        Largest relative error of stated speeds [-].
    warmer : float
        True less stated temperature [K].
    responses : str
        Quality of the hammer test: ``good``, ``poor`` or ``none``.
    start : str
        Key of `STARTS`; empty where recordings are settled.
    """

    departures: tuple[str, ...] = ()
    rate: float = 30e3
    seconds: float = 0.5
    noise: Mapping[str, float] = field(default_factory=lambda: dict(Acquisition().noise))
    bits: int = 0
    ranges: float = 1.0
    stated: bool = False
    law: str = ""
    sizes: Mapping[str, float] = field(default_factory=lambda: dict.fromkeys(SIZES, 1.0))
    listed: tuple[LawSpec, ...] = ()
    repeats: bool = True
    wrong_speed: float = 0.0
    warmer: float = 0.0
    responses: str = "good"
    start: str = ""

    @property
    def angle(self) -> float:
        """Factor on angles [-]."""
        return self.sizes["torque"] / self.sizes["elastomer_stiffness"]

    @property
    def time(self) -> float:
        """Factor on times, such as the length of a slip [-]."""
        return math.sqrt(self.sizes["elastomer_inertia"] / self.sizes["elastomer_stiffness"])

    @property
    def pace(self) -> float:
        """Factor on speeds [-]."""
        return self.angle / self.time

    def sensors(self, largest: Mapping[str, float]) -> Sensors:
        """Return the sensors of the bench.

        Parameters
        ----------
        largest : mapping of str to float
            Largest expected values by channel; the range of the converter is doubled until they
            fit [unit of the channel].
        """

        def sensor(kind: str, noise: float) -> Sensor:
            if not self.bits:
                return Sensor(noise)
            usual = self.ranges * (THESIS_CONVERTER.of(kind).full_scale or 1.0)
            doubled = math.ceil(math.log2(max(largest.get(kind, 0.0) / usual, 1.0)))
            return Sensor(noise, full_scale=usual * 2.0**doubled, bits=self.bits)

        return Sensors({kind: sensor(kind, noise) for kind, noise in self.noise.items()})


def draw_bench(rng: Rng) -> Bench:
    """Draw a bench.

    Examples
    --------
    >>> bench = draw_bench(np.random.default_rng(0))
    >>> bool(bench.law) == ("laws" in bench.departures)
    True
    """
    usual = Acquisition().noise
    bench = Bench(
        rate=float(rng.choice(_RATES)),
        seconds=float(rng.choice((0.4, 0.5, 0.6, 0.8, 1.0))),
        noise={kind: level * float(rng.uniform(*NOISE_DRAWN)) for kind, level in usual.items()},
        stated=bool(rng.random() < 0.5),
    )
    if rng.random() < 0.3:
        return bench
    met = ["laws"] if rng.random() < 0.7 else []
    count = max(int(rng.choice(5, p=(0.12, 0.3, 0.28, 0.2, 0.1))), 1 - len(met))
    often = np.array([share for share, _ in DEPARTURES.values()])
    met += rng.choice(list(DEPARTURES), count, replace=False, p=often / often.sum()).tolist()
    if "laws" in met:
        bench = replace(bench, law=picked(OWN_LAWS, rng))
    for name, (_, draw) in DEPARTURES.items():
        if name in met:
            bench = replace(bench, **draw(rng))
    # Motion with a law other than the constant one takes ten times as long to compute.
    longest = math.inf if not bench.law else 1.6 if "records" in met else 0.7
    return replace(bench, departures=tuple(met), seconds=min(bench.seconds, longest))


def _sensors(rng: Rng) -> dict[str, Any]:
    return {
        "noise": {k: x * log_uniform(0.2, 6.0, rng) for k, x in Acquisition().noise.items()},
        "bits": int(rng.integers(12, 17)) if rng.random() < 0.55 else 0,
        "ranges": log_uniform(0.5, 2.0, rng),
    }


def _records(rng: Rng) -> dict[str, Any]:
    long = math.log(5.0 / 0.3) * float(rng.random()) ** 4.0  # long recordings are rare
    rates = (12_000, 16_000, 20_000, 22_050, *_RATES, 65_536, 96_000)
    return {"rate": float(rng.choice(rates)), "seconds": round(0.3 * math.exp(long), 2)}


def _listed(rng: Rng) -> dict[str, Any]:
    names = rng.choice(sorted(EFFECTS), int(rng.integers(1, 3)), replace=False).tolist()
    drawn = (drawn_effect(name, log_uniform(0.05, 0.6, rng), rng) for name in names)
    return {"listed": tuple(drawn)}


DEPARTURES: Mapping[str, tuple[float, Callable[[Rng], dict[str, Any]]]] = {
    "sensors": (2.2, _sensors),
    "records": (1.2, _records),
    "sizes": (1.2, lambda rng: {
        "sizes": {name: log_uniform(1.0 / 3.4, 3.4, rng) for name in SIZES}}),
    "listed": (0.9, _listed),
    "single": (1.1, lambda _rng: {"repeats": False}),
    "conditions": (1.1, lambda rng: {
        "wrong_speed": 0.04, "warmer": float(rng.uniform(-6.0, 6.0))}),
    "responses": (1.1, lambda rng: {"responses": "poor" if rng.random() < 0.67 else "none"}),
    "starts": (1.2, lambda rng: {"start": str(rng.choice(list(STARTS)))}),
}  # fmt: skip
"""Departures from a quiet bench other than the friction law: relative frequency, and a function
that draws the changed fields of `Bench`."""


_FITS = {0.178e-3: (430.0, 5.35, 4.0), 0.279e-3: (665.0, 10.7, 8.0), 0.381e-3: (1011.0, 27.0, 20.0)}
"""Stiffness [Nm/rad], critical and kinetic torque [Nm] at each interference [m]: Table 4.1."""

_CREEPING = {0.178e-3: 3.0, 0.279e-3: 4.5, 0.381e-3: 8.0}
"""Speed up to which each interference sticks and slips [rad/s]; most recordings lie below."""

_DAMPING = {2214.0: 0.105, 3745.0: 0.085, FIXED: 0.085}
"""Damping with each support [Nm s/rad]."""


@dataclass(frozen=True)
class Setting:
    """Rig, bench and conditions of a case.

    Parameters
    ----------
    rig : Rig
        Content of the rig file.
    conditions : tuple of KnownCondition
        Stated condition of each recording.
    bench : Bench
    sensors : Sensors
        True sensors, whether the rig file states them or not.
    """

    rig: Rig
    conditions: tuple[KnownCondition, ...]
    bench: Bench
    sensors: Sensors


def draw_setting(rng: Rng) -> Setting:
    """Draw a bench, a rig, and two to nine recordings.

    Examples
    --------
    >>> import numpy as np
    >>> setting = draw_setting(np.random.default_rng(0))
    >>> 2 <= len(setting.conditions) <= 9
    True
    """
    bench = draw_bench(rng)
    rig = _rig(bench, rng)
    conditions = _conditions(rig, bench, rng)
    if bench.law and bench.law not in MATERIALS:  # few users bring silent rigs
        for _ in range(4):
            if _vibrates(rig, conditions[:2]):
                break
            rig = replace(rig, friction=_law(draw_law(bench.law, rng), bench))
    largest = {
        "torque": 2.0 * max(fit.critical_torque for fit in rig.fits),
        "angle": 1.3 * bench.seconds * max(c.speed for c in conditions),
    }
    sensors = bench.sensors(largest)
    stated = sensors if bench.stated else Sensors(noise_from_recordings=True)
    return Setting(replace(rig, sensors=stated), conditions, bench, sensors)


def _rig(bench: Bench, rng: Rng) -> Rig:
    """Draw a rig near the thesis's, or near that of a material, of the size of its bench."""
    thesis = load_material_rig("fluorocarbon-thesis")
    if bench.law in MATERIALS:
        plain = load_material_rig(bench.law)
        if rng.random() < 0.4:
            plain = constant_version(plain)
    else:
        # An elastic contact takes a part of the drop of torque.
        steeper = float(rng.uniform(1.0, 2.2)) if bench.law else 1.0
        fits = tuple(
            Fit(interference, stiffness, kinetic + steeper * (critical - kinetic), kinetic,
                _DAMPING)
            for interference, (stiffness, critical, kinetic) in _FITS.items()
        )  # fmt: skip
        law = draw_law(bench.law, rng) if bench.law else LawSpec("coulomb", {})
        plain = replace(thesis, fits=fits, friction=law, elastomer_damping_share=0.5, effects=())
        if bench.law and rng.random() < 0.3:
            scatter = float(rng.uniform(0.1, 0.4))
            plain = replace(plain, effects=(
                LawSpec("critical_torque_scatter", {"form": "uniform", "scatter": scatter}),
            ))  # fmt: skip
    if bench.law:
        plain = replace(plain, friction=_law(plain.friction, bench))
    known = {spec.name for spec in plain.effects}
    return replace(
        plain,
        elastomer_inertia=_about(bench.sizes["elastomer_inertia"] / 65000.0, rng),
        clamp_inertia=_about(bench.sizes["clamp_inertia"] / 1200.0, rng),
        fits=tuple(_sized(fit, bench, rng) for fit in plain.fits),
        effects=(*plain.effects, *(spec for spec in bench.listed if spec.name not in known)),
    )


def _law(law: LawSpec, bench: Bench) -> LawSpec:
    return scaled_law(law, angle=bench.angle, time=bench.time, torque=bench.sizes["torque"])


def _vibrates(rig: Rig, conditions: Sequence[KnownCondition]) -> bool:
    """Return whether a rig vibrates at one of its conditions."""
    for c in conditions:
        motion = simulate_motion(
            rig, ConstantSpeed(c.speed), interference=c.interference,
            support_stiffness=c.support_stiffness, seconds=0.2, rate=REGIME_RATE, effects=(),
            tolerance=DIAGNOSIS.tolerance,
        )  # fmt: skip
        late = motion.torque[motion.torque.size // 2 :]
        if late.std() > 0.01 * abs(late.mean()):
            return True
    return False


def _sized(fit: Fit, bench: Bench, rng: Rng) -> Fit:
    """Return a fit of a rig of another size, with scatter of its numbers."""
    size = bench.sizes
    inertia = math.sqrt(size["elastomer_inertia"] * size["clamp_inertia"])
    damping = math.sqrt(size["elastomer_stiffness"] * inertia)
    torque = _about(size["torque"], rng)
    return replace(
        fit,
        elastomer_stiffness=_about(fit.elastomer_stiffness * size["elastomer_stiffness"], rng),
        critical_torque=fit.critical_torque * torque,
        kinetic_torque=fit.kinetic_torque * torque,
        damping={
            _support(support, bench): _about(c * damping, rng) for support, c in fit.damping.items()
        },
    )


def _about(value: float, rng: Rng) -> float:
    return value * math.exp(0.08 * float(rng.standard_normal()))


def _support(support: float, bench: Bench) -> float:
    """Return the stiffness of a support on a bench of another size; a fixed clamp stays fixed."""
    return float(round(support * bench.sizes["support"])) if support != FIXED else FIXED


def _conditions(rig: Rig, bench: Bench, rng: Rng) -> tuple[KnownCondition, ...]:
    again = 2 if bench.repeats else 0
    together = 4.2 if bench.law else 6.5  # longest sum of the recordings of a case [s]
    most = int(together / (bench.seconds + DIAGNOSIS.settling)) - again
    different = min(int(rng.integers(2, 8)), max(most, 2))
    known = sorted(rig.fits[0].damping)
    supports = rng.choice(known, rng.integers(1, 3), replace=False).tolist()
    interferences = [fit.interference for fit in rig.fits]
    count = min(int(rng.integers(1, 4)), len(interferences))
    fits = rng.choice(interferences, count, replace=False).tolist()
    drawn: list[KnownCondition] = []
    while len(drawn) < different:
        fit = fits[int(rng.integers(len(fits)))]
        creeping = _CREEPING.get(fit, 12.0)
        fastest = creeping if rng.random() < 0.9 else max(10.0, creeping)
        speed = bench.pace * math.exp(rng.uniform(math.log(0.6), math.log(fastest)))
        condition = KnownCondition(
            speed=float(f"{speed:.2g}"),
            interference=fit,
            support_stiffness=supports[int(rng.integers(len(supports)))],
            material=rig.material,
            temperature=23.0,
        )
        if condition not in drawn:
            drawn.append(condition)
    return tuple(drawn + [drawn[i] for i in rng.choice(different, again, replace=False)])
