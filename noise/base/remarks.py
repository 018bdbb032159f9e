"""Remarks on a rig and its use that the user should know of: one line each, said once.

They go to standard error and into the sidecar of what is made: what lies outside the usual, what
was not measured but held or interpolated, what cannot change anything.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from models.condition import CONDITION
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
    """Remarks on a rig and the conditions that it is used at.

    Parameters
    ----------
    rig : Rig
    speed, interference, support_stiffness, temperature : sequence of float
        [rad/s], [m], [Nm/rad], [degree Celsius]

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rig = load_material_rig("fluorocarbon")
    >>> use_remarks(rig, speed=[15.0], interference=[0.279e-3], support_stiffness=[2214.0])
    ['speed 15 rad/s is beyond 13, the fastest that the numbers of fluorocarbon were fitted at']
    """
    finite = [stiffness for stiffness in support_stiffness if math.isfinite(stiffness)]
    beyond = _speed_remark(rig, speed)
    fit = CONDITION["interference"]
    found = [
        *remarks(rig),
        beyond or CONDITION["speed"].remark(*speed),
        fit.remark(*map(fit.of, interference)),
        CONDITION["support_stiffness"].remark(*finite),
        CONDITION["temperature"].remark(*temperature),
        _support_remark(rig, support_stiffness),
        _anchor_remark(rig, finite),
    ]
    return [text for text in dict.fromkeys(found) if text]


def _speed_remark(rig: Rig, asked: Sequence[float]) -> str:
    fastest = max(abs(value) for value in asked)
    if fastest <= rig.fastest_fitted * (1.0 + 1e-9):
        return ""
    return (
        f"speed {fastest:g} rad/s is beyond {rig.fastest_fitted:.4g}, the fastest that the "
        f"numbers of {rig.material} were fitted at"
    )


def _support_remark(rig: Rig, asked: Sequence[float]) -> str:
    given = sorted({support for fit in rig.fits for support in fit.damping})
    if len(given) == 1:  # one damping for every support
        return ""
    other = [k for k in asked if not any(math.isclose(k, each, rel_tol=0.01) for each in given)]
    if not other:
        return ""
    named = ", ".join(_stiffness(each) for each in given)
    outside = [k for k in other if not given[0] <= k <= given[-1]]
    how = (
        "that of the nearest is used" if outside == other else "it is interpolated, or held beyond"
    )
    how = "it is interpolated between these" if not outside else how
    return (
        f"damping is given for supports of {named}; for "
        f"{', '.join(_stiffness(k) for k in other)} Nm/rad {how}"
    )


def _anchor_remark(rig: Rig, asked: Sequence[float]) -> str:
    if math.isinf(rig.beams.anchor_rotation) and math.isinf(rig.beams.anchor_translation):
        return ""
    from models.structure.beams import on_anchors

    rigid = [k for k in asked if on_anchors(rig.beams, k, rig.clamp_inertia) is not rig.beams]
    if not rigid:
        return ""
    return (
        f"on anchors that yield, beams for {', '.join(_stiffness(k) for k in rigid)} Nm/rad would "
        "have more inertia than the clamp has in all; their anchors are taken as rigid"
    )


def _stiffness(value: float) -> str:
    return "fixed" if math.isinf(value) else f"{value:g}"


def temperature_remark(rig: Rig, *asked: float | None) -> str:
    """Say what temperatures that were asked for do to a rig; empty for that of its numbers.

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
    depends = rig.temperature
    reference = depends.reference if depends else math.nan
    given = sorted({value for value in asked if value is not None and value != reference})
    if not given:
        return ""
    said = f"temperature {' to '.join(f'{t:g}' for t in dict.fromkeys((given[0], given[-1])))}"
    if depends is None:
        return (
            f"{said} degree Celsius is recorded and changes nothing: {rig.material} states no "
            "[temperature]"
        )
    (low, high), trust = depends.range, "that is assumed, not measured"
    if given[0] < low:
        trust = f"held at {low:g}, its glass transition, below which it is no elastomer"
    elif given[-1] > high:
        trust = f"WLF holds up to {high:g}, 100 K above its glass transition, and is extrapolated"
    return (
        f"{said} degree Celsius: friction, stiffness and damping of {rig.material} are those given "
        f"at {reference:g}, shifted by WLF; {trust}"
    )


def effect_remarks(rig: Rig, library: Mapping[str, Effect]) -> list[str]:
    """Name effects of a rig that cannot act on its friction law.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.effects import EFFECTS
    >>> effect_remarks(load_material_rig("fluorocarbon"), EFFECTS)
    []
    """
    from sim.effects.effect import activated
    from sim.rig_effects import can_act

    return [
        f"effect {active.effect.name} cannot act on friction law {rig.friction.name} and changes "
        "nothing"
        for active in activated(rig.effects, library)
        if not can_act(active, rig.friction)
    ]


def constant_remark(rigs: Iterable[Rig], what: str) -> str:
    """Say what is told of rigs without the irregularity that they state; empty where none does.

    Parameters
    ----------
    rigs : iterable of Rig
    what : str
        Is told of the constant version: the subject of the sentence, in the plural.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> constant_remark([load_material_rig("natural-rubber")], "critical speeds")
    'critical speeds are of the constant version, without critical_torque_scatter, which ...'
    >>> constant_remark([load_material_rig("PDMS")], "critical speeds")
    ''
    """
    from sim.rig_effects import irregular_effects

    left_out = dict.fromkeys(spec.name for rig in rigs for spec in irregular_effects(rig))
    if not left_out:
        return ""
    verb = "makes" if len(left_out) == 1 else "make"
    return (
        f"{what} are of the constant version, without {' and '.join(left_out)}, which {verb} one "
        "slip differ from the next by chance"
    )


def sensor_remarks(sensors: Sensors, rate: float) -> list[str]:
    """Say what of a rig's sensors a simulated recording at a rate [Hz] cannot have.

    Examples
    --------
    >>> from models.sensors import Sensor, Sensors
    >>> sensor_remarks(Sensors({"torque": Sensor(antialias=10e3)}), 30e3)
    []
    """
    found = []
    if sensors.noise_from_recordings:
        found.append(
            'noise = "from recordings" is estimated where recordings are compared; here, without '
            "any, the noise of good sensors is used"
        )
    corners = (sensor.antialias for sensor in sensors.by_kind.values())
    high = sorted({corner for corner in corners if corner is not None and corner > 0.5 * rate})
    if high:
        found.append(
            f"antialias_hz = {high[0]:g} lies above half the sampling rate, {0.5 * rate:g} Hz; "
            "what such a filter would let through and fold back is left out"
        )
    return found


def clipping_remarks(recording: Recording, sensors: Sensors) -> list[str]:
    """Say which channels of a recording reach the ends of their sensors' ranges.

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel, Recording
    >>> from models.sensors import Sensor, Sensors
    >>> held = Recording(np.full((1, 4), 2.0), 1e3, (Channel("torque"),))
    >>> clipping_remarks(held, Sensors({"torque": Sensor(full_scale=2.0)}))
    ['torque reaches the range of its sensor, 2 N m, in 4 of 4 samples']
    """
    found = []
    for channel, row in zip(recording.channels, recording.samples, strict=True):
        sensor = sensors.of(channel.kind)
        if sensor.full_scale is None:
            continue
        ends = int((abs(row) >= sensor.full_scale - 1.5 * sensor.step).sum())
        if ends:
            found.append(
                f"{channel.name} reaches the range of its sensor, {sensor.full_scale:g} "
                f"{channel.unit}, in {ends} of {row.size} samples"
            )
    return found
