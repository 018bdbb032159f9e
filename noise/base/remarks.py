"""Remarks on a rig and its operating conditions, one line each.

They name values outside the usual range, values that are extrapolated or interpolated, and settings
without effect. Commands print them and write them into sidecars.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from models.condition import CONDITION, support_name
from models.schema import remarks

if TYPE_CHECKING:
    from models.recording import Recording
    from models.rig import Rig
    from models.sensors import Sensors
    from sim.effects.effect import Effect


NEVER_SLIPS = (
    "nothing slips in this run: the contact sticks from beginning to end, so there is no friction "
    "noise; check critical_torque_Nm, or let it turn for longer"
)


def use_remarks(
    rig: Rig,
    *,
    speed: Sequence[float],
    interference: Sequence[float],
    support_stiffness: Sequence[float],
    temperature: Sequence[float] = (),
) -> list[str]:
    """Return remarks on a rig and the conditions at which it is used.

    Parameters
    ----------
    rig : Rig
    speed, interference, support_stiffness, temperature : sequence of float
        [rad/s], [m], [Nm/rad], [degree Celsius]

    Returns
    -------
    list of str

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rig = load_material_rig("fluorocarbon")
    >>> use_remarks(rig, speed=[15.0], interference=[0.279e-3], support_stiffness=[2214.0])
    ['speed 15 rad/s is above 13 rad/s, the highest speed to which fluorocarbon was fitted']
    """
    finite = [stiffness for stiffness in support_stiffness if math.isfinite(stiffness)]
    fit, fastest = CONDITION["interference"], max(abs(value) for value in speed)
    speed_remark = CONDITION["speed"].remark(*speed)
    if fastest > rig.fastest_fitted * (1.0 + 1e-9):
        speed_remark = (
            f"speed {fastest:g} rad/s is above {rig.fastest_fitted:.4g} rad/s, the highest speed "
            f"to which {rig.material} was fitted"
        )
    lines = [
        *remarks(rig),
        speed_remark,
        fit.remark(*map(fit.of, interference)),
        fits_remark(rig, interference),
        CONDITION["support_stiffness"].remark(*finite),
        CONDITION["temperature"].remark(*temperature),
    ]
    known = sorted({support for fit in rig.fits for support in fit.damping})
    others = [
        k for k in support_stiffness if not any(math.isclose(k, one, rel_tol=0.01) for one in known)
    ]
    if len(known) > 1 and others:
        lines.append(
            f"damping is given for supports of {', '.join(map(support_name, known))}; for "
            f"{', '.join(map(support_name, others))} Nm/rad it is interpolated, or held beyond "
            "these"
        )
    if math.isfinite(min(rig.beams.anchor_rotation, rig.beams.anchor_translation)):
        from models.structure.beams import on_anchors

        rigid = [k for k in finite if on_anchors(rig.beams, k, rig.clamp_inertia) is not rig.beams]
        if rigid:
            lines.append(
                f"on elastic anchors, beams for {', '.join(map(support_name, rigid))} Nm/rad would "
                "have more inertia than the clamp itself; their anchors are taken as rigid"
            )
    return [text for text in dict.fromkeys(lines) if text]


def fits_remark(rig: Rig, interference: Sequence[float]) -> str:
    """Return a remark on interferences without a fit of their own; empty if there are none.

    Parameters
    ----------
    rig : Rig
    interference : sequence of float
        [m]

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> fits_remark(load_material_rig("PDMS"), [0.178e-3, 0.254e-3, 0.3e-3])
    'fits are given for 0.254 and 0.381 mm; for 0.178 mm the nearest is held, for 0.3 mm they are...
    """
    given = [fit.interference for fit in rig.fits]
    held: list[float] = []
    within: list[float] = []
    for fit in interference:
        if not any(math.isclose(one, fit, rel_tol=0.01) for one in given):
            (within if given[0] < fit < given[-1] else held).append(1e3 * fit)
    parts = [f"for {axis_words(held)} mm the nearest is held"] if held else []
    parts += [f"for {axis_words(within)} mm they are interpolated"] if within else []
    known = axis_words([1e3 * fit for fit in given])
    return f"fits are given for {known} mm; {', '.join(parts)}" if parts else ""


def axis_words(values: Sequence[float], most: int = 4) -> str:
    """Return the values of an axis as text, or only its ends and number above `most` values.

    Parameters
    ----------
    values : sequence of float
        In the unit of the axis, such as [rad/s].
    most : int

    Examples
    --------
    >>> axis_words([2214.0, math.inf]), axis_words([0.25, 0.5, 0.75], most=2)
    ('2214 and fixed', '0.25 to 0.75 (3 values)')
    """
    texts = ["fixed" if math.isinf(value) else f"{value:.4g}" for value in values]
    if len(texts) > most:
        return f"{texts[0]} to {texts[-1]} ({len(texts)} values)"
    return " and ".join([", ".join(texts[:-1]), texts[-1]] if len(texts) > 1 else texts)


def temperature_remark(rig: Rig, *temperatures: float | None) -> str:
    """Return a remark on the effect of temperatures; empty at the rig's reference temperature.

    Parameters
    ----------
    rig : Rig
    *temperatures : float, optional
        [degree Celsius]; None counts as the reference temperature.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> temperature_remark(load_material_rig("fluorocarbon-thesis"), 80.0)
    'temperature 80 degree Celsius is recorded and changes nothing: fluorocarbon-thesis states no \
[temperature]'
    >>> temperature_remark(load_material_rig("fluorocarbon"), 23.0)
    ''
    >>> temperature_remark(load_material_rig("fluorocarbon"), 5.0)
    'temperature 5 degree Celsius: friction, stiffness and damping of fluorocarbon are those given \
at 23, shifted by WLF; that is assumed, not measured'
    """
    dependence = rig.temperature
    reference = dependence.reference if dependence else math.nan
    other = sorted({value for value in temperatures if value is not None and value != reference})
    if not other:
        return ""
    subject = f"temperature {' to '.join(f'{t:g}' for t in dict.fromkeys((other[0], other[-1])))}"
    if dependence is None:
        return (
            f"{subject} degree Celsius is recorded and changes nothing: {rig.material} states no "
            "[temperature]"
        )
    (low, high), trust = dependence.range, "that is assumed, not measured"
    if other[0] < low:
        trust = f"held at {low:g}, its glass transition, below which it is no elastomer"
    elif other[-1] > high:
        trust = f"WLF holds up to {high:g}, 100 K above its glass transition, and is extrapolated"
    return (
        f"{subject} degree Celsius: friction, stiffness and damping of {rig.material} are those "
        f"given at {reference:g}, shifted by WLF; {trust}"
    )


def effect_remarks(rig: Rig, library: Mapping[str, Effect]) -> list[str]:
    """Return remarks on effects of a rig that its friction law makes ineffective.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.effects import EFFECTS
    >>> effect_remarks(load_material_rig("fluorocarbon"), EFFECTS)
    []
    """
    from sim.effects.effect import activated
    from sim.friction import friction_law

    if friction_law(rig.friction.name).torque is None:
        return []
    return [
        f"effect {active.effect.name} cannot act on friction law {rig.friction.name} and changes "
        "nothing"
        for active in activated(rig.effects, library)
        if active.effect.of_true_stick
    ]


def clipping_remarks(recording: Recording, sensors: Sensors) -> list[str]:
    """Return remarks on channels that reach the limits of their sensors.

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel, Recording
    >>> from models.sensors import Sensor, Sensors
    >>> clipped = Recording(np.full((1, 4), 2.0), 1e3, (Channel("torque"),))
    >>> clipping_remarks(clipped, Sensors({"torque": Sensor(full_scale=2.0)}))
    ['torque reaches the range of its sensor, 2 N m, in 4 of 4 samples']
    """
    lines = []
    for channel, row in zip(recording.channels, recording.samples, strict=True):
        sensor = sensors.of(channel.kind)
        if sensor.full_scale is None:
            continue
        ends = int((abs(row) >= sensor.full_scale - 1.5 * sensor.step).sum())
        if ends:
            lines.append(
                f"{channel.name} reaches the range of its sensor, {sensor.full_scale:g} "
                f"{channel.unit}, in {ends} of {row.size} samples"
            )
    return lines
