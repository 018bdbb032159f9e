"""Rigs as users have them, and the conditions that they record; drawn without knowing the cause."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from models.condition import FIXED, KnownCondition
from models.rig import Fit, LawSpec, Rig
from models.rig_file import load_material_rig
from models.sensors import Sensors
from noise.base.arrays import Rng
from noise.training.causes.cases.benches import MATERIALS, Bench, draw_bench, draw_law, scaled_law
from sim.motion import simulate_motion
from sim.plan import DIAGNOSIS, REGIME_RATE
from sim.rig_effects import constant_version
from sim.shaft import ConstantSpeed

_FITS = {0.178e-3: (430.0, 5.35, 4.0), 0.279e-3: (665.0, 10.7, 8.0), 0.381e-3: (1011.0, 27.0, 20.0)}
"""Stiffness [Nm/rad], critical and kinetic torque [Nm] at each interference [m]: Table 4.1."""

_CREEPING = {0.178e-3: 3.0, 0.279e-3: 4.5, 0.381e-3: 8.0}
"""Speed up to which each fit sticks and slips [rad/s]; most recordings lie below it."""

_ELSEWHERE = 12.0
"""That of the fits of other materials."""

_DAMPING = {2214.0: 0.105, 3745.0: 0.085, FIXED: 0.085}
"""Of each support [Nm s/rad]."""

_DESIGN_SPREAD = 0.08
"""Relative standard deviation of a rig's numbers from those of the thesis."""

_STEEPER = (1.0, 2.2)
"""By what the drop of torque is larger where the contact is elastic, which takes a part of it."""

_STATED_SCATTER = 0.3
"""Share of the rigs with a law of their own that state a scatter of the critical torque."""

_FASTEST = 10.0
_SLOWEST = 0.6

_SIMULATED = {True: 6.5, False: 4.2}
"""Seconds that the recordings of a case may last together, settling included, before conditions are
made fewer: where the law is the constant one, and where it is not."""

_TRIES, _LOOKED_AT, _A_WHILE, _LEAST_SWING = 4, 2, 0.2, 0.01
"""Draws of a law until a rig vibrates, conditions at which that is seen, for how long [s], and the
torque's standard deviation over its mean [-]: nobody brings many rigs that are silent."""


@dataclass(frozen=True)
class Setting:
    """A rig, and how it is recorded.

    Parameters
    ----------
    rig : Rig
        As its file has it.
    conditions : tuple of KnownCondition
        What is stated of the recordings, one each.
    bench : Bench
    sensors : Sensors
        Through which it is recorded, whether the file says so or not.
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
    if bench.law and bench.law not in MATERIALS:
        for _ in range(_TRIES):
            if _vibrates(rig, conditions[:_LOOKED_AT]):
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
    """Draw a rig about the thesis's, or about a material's, as large as its bench says."""
    thesis = load_material_rig("fluorocarbon-thesis")
    if bench.law in MATERIALS:
        plain = load_material_rig(bench.law)
        if rng.random() < 0.4:
            plain = constant_version(plain)
    else:
        steeper = float(rng.uniform(*_STEEPER)) if bench.law else 1.0
        fits = tuple(
            Fit(interference, stiffness, kinetic + steeper * (critical - kinetic), kinetic,
                _DAMPING)
            for interference, (stiffness, critical, kinetic) in _FITS.items()
        )  # fmt: skip
        law = draw_law(bench.law, rng) if bench.law else LawSpec("coulomb", {})
        plain = replace(thesis, fits=fits, friction=law, elastomer_damping_share=0.5, effects=())
        if bench.law and rng.random() < _STATED_SCATTER:
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
    """Whether a rig does anything but slide evenly at one of its conditions."""
    for c in conditions:
        motion = simulate_motion(
            rig, ConstantSpeed(c.speed), interference=c.interference,
            support_stiffness=c.support_stiffness, seconds=_A_WHILE, rate=REGIME_RATE, effects=(),
            tolerance=DIAGNOSIS.tolerance,
        )  # fmt: skip
        late = motion.torque[motion.torque.size // 2 :]
        if late.std() > _LEAST_SWING * abs(late.mean()):
            return True
    return False


def _sized(fit: Fit, bench: Bench, rng: Rng) -> Fit:
    """Return a fit of a rig of another size, about which its numbers scatter."""
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
    return value * math.exp(_DESIGN_SPREAD * float(rng.standard_normal()))


def _support(support: float, bench: Bench) -> float:
    """Return the stiffness of a support on a bench of another size; a bolted clamp stays so."""
    return float(round(support * bench.sizes["support"])) if support != FIXED else FIXED


def _conditions(rig: Rig, bench: Bench, rng: Rng) -> tuple[KnownCondition, ...]:
    again = 2 if bench.repeats else 0
    most = int(_SIMULATED[not bench.law] / (bench.seconds + DIAGNOSIS.settling)) - again
    different = min(int(rng.integers(2, 8)), max(most, 2))
    known = sorted(rig.fits[0].damping)
    supports = rng.choice(known, rng.integers(1, 3), replace=False).tolist()
    interferences = [fit.interference for fit in rig.fits]
    count = min(int(rng.integers(1, 4)), len(interferences))
    fits = rng.choice(interferences, count, replace=False).tolist()
    drawn: list[KnownCondition] = []
    while len(drawn) < different:
        fit = fits[int(rng.integers(len(fits)))]
        creeping = _CREEPING.get(fit, _ELSEWHERE)
        fastest = creeping if rng.random() < 0.9 else max(_FASTEST, creeping)
        speed = bench.pace * math.exp(rng.uniform(math.log(_SLOWEST), math.log(fastest)))
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
