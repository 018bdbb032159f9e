"""Diagnoses put together by hand around short simulated runs, one of each kind."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from models.recording import Recording
from models.rig import LawSpec
from models.rig_file import load_material_rig
from noise.diagnosis.outcome import (
    Agreement,
    Diagnosis,
    EffectFinding,
    Illustration,
    Location,
    StageFinding,
)
from sim.run import simulate

STAGES = {
    "drive": StageFinding(1.02, 0.02, 0.41),
    "friction": StageFinding(7.7, 0.71, 0.00042),
    "structure": StageFinding(2.1, 0.15, 0.031),
    "radiation": StageFinding(1.6, 0.10, 0.07),
    "measurement": StageFinding(0.98, 0.02, 0.62),
}
SLIGHT = StageFinding(1.0, 0.2, 0.5)
PLACE = Location("friction", ("torque",), (0.0, 1800.0), "stick", "speed_rad_s >= 2.5", 0.00042)
SMALL = {"clipping": 0.004, "mains_hum": 0.003, "gain_error": 0.002, "none": 0.0005}
PARAMETERS = {
    "elastomer_stiffness": (0.98, 1.01),
    "kinetic_torque": (0.995, 1.012),
    "critical_torque": (0.97, 1.02),
    "damping": (0.81, 0.93),
}


AGREEMENT = (
    Agreement("run03", 2.5, 0.381e-3, 7.7, {"torque": 9.1, "acceleration": 6.0, "pressure": 2.2}),
    Agreement("run07", 1.0, 0.381e-3, 1.2, {"torque": 1.4, "acceleration": 0.9, "pressure": 1.1}),
)


@cache
def run(*effects, seconds=0.6):
    rig = load_material_rig("fluorocarbon-thesis")
    specs = tuple(LawSpec(name, dict(parameters)) for name, parameters in effects)
    run = simulate(replace(rig, effects=specs), 2.5, interference=0.381e-3, seconds=seconds)
    return run.recording


def only(recording, *names):
    rows = [recording.channel_names.index(name) for name in names]
    channels = tuple(recording.channels[row] for row in rows)
    return Recording(recording.samples[rows], recording.rate, channels, recording.condition)


PARTIAL = ("partial_slip", (("share", 0.6),))
HUM = ("mains_hum", (("amount", 3.0),))


def illustration(name, measured, before, after):
    return Illustration(name, measured, before, after)


def base(verdict, **others):
    known = {
        "equivalent": (),
        "location": PLACE,
        "stages": STAGES,
        "effects": (),
        "probabilities": {},
        "parameters": PARAMETERS,
        "next_measurement": "",
        "held_out": ("run03", "run07"),
        "gap": 7.9,
        "floor": 1.0,
        "p_value": 0.0004,
        "seconds": 21.4,
        "agreement": AGREEMENT,
    }
    return Diagnosis(verdict=verdict, **(known | others))


def none():
    return base(
        (),
        location=None,
        stages=dict.fromkeys(STAGES, SLIGHT),
        probabilities={"none": 0.93, "parameters": 0.05, "unknown": 0.01} | {"clipping": 0.004},
        parameters={},
        gap=0.92,
        p_value=0.61,
        agreement=AGREEMENT[1:],
        illustrations=(illustration("run03", run(), run(), None),),
    )


def parameters():
    tried = EffectFinding(
        "partial_slip", "friction", 0.03,
        gap_before=4.4, gap_recalibrated=1.1, gap_after=1.1, gap_floor=1.0,
    )  # fmt: skip
    return base(
        ("parameters",),
        effects=(tried,),
        probabilities={"parameters": 0.95, "partial_slip": 0.03, **SMALL},
        parameters=PARAMETERS | {"critical_torque": (1.12, 1.16)},
        next_measurement="A push test of the bushing at 2 and 5 Hz.",
        illustrations=(illustration("run03", run(PARTIAL), run(), run(PARTIAL)),),
    )


def one_effect():
    found = EffectFinding(
        "partial_slip", "friction", 0.96, {"share": 0.58, "exponent": 4.4, "form": "power"},
        (0.52, 0.66), 7.7, 4.1, 1.3, 1.0, 0.955, 0.91, 0.99, 0.90,
    )  # fmt: skip
    second = EffectFinding(
        "static_ageing", "friction", 0.31, {"share": 0.4, "ageing_time": 2e-3}, (0.1, 0.6),
        7.7, 4.1, 3.2, 1.0, 0.67, 0.5, 0.8, 0.29,
    )  # fmt: skip
    return base(
        ("partial_slip",),
        equivalent=(("partial_slip", "amplitude_softening"),),
        effects=(found, second),
        probabilities={"partial_slip": 0.96, "static_ageing": 0.31, "parameters": 0.02,
                       "amplitude_softening": 0.06, "unknown": 0.01, **SMALL},
        next_measurement="The same conditions at 0.5 rad/s: there, creep during stick and "
        "softening at large amplitude part.",
        notes=("No angle channel: the drive is taken to turn evenly, and a speed fluctuation "
               "below 1 % cannot be told from scatter of the critical torque.",
               "pressure of run05 is clipped in 0.3 % of its samples; it was left out."),
        illustrations=(
            illustration("run03", run(PARTIAL), run(), run(PARTIAL)),
            illustration("a/very_long_name_of_a_recording" * 3, run(HUM), run(), run(HUM)),
        ),
    )  # fmt: skip


def pair():
    joint = (0.97, 0.93, 0.99)
    gaps = (9.4, 6.0, 1.2, 1.0)
    found = (
        EffectFinding("partial_slip", "friction", 0.91, {"share": 0.6}, (0.5, 0.7), *gaps, *joint,
                      0.95),
        EffectFinding("further_trouble", "measurement", 0.78, {"amount": 2.9}, (2.4, 3.3), *gaps,
                      *joint, 0.95),
    )  # fmt: skip
    return base(
        ("partial_slip", "further_trouble"),
        effects=found,
        stages=STAGES | {"measurement": StageFinding(3.1, 0.2, 0.004)},
        probabilities={"partial_slip": 0.91, "further_trouble": 0.78, "unknown": 0.06, **SMALL},
        illustrations=(
            illustration("run03", run(PARTIAL, HUM), run(), run(PARTIAL, HUM)),
        ),
    )  # fmt: skip


def unknown():
    tried = EffectFinding(
        "velocity_weakening", "friction", 0.12, {"share": 0.2}, (0.0, 0.4), 7.7, 5.2, 4.8, 1.0,
        0.43, 0.2, 0.6, 0.09,
    )  # fmt: skip
    return base(
        ("unknown",),
        effects=(tried,),
        probabilities={"unknown": 0.88, "velocity_weakening": 0.12, **SMALL},
        next_measurement="Two speeds more, with the clamp bolted down.",
        illustrations=(illustration("run03", run(PARTIAL), run(), None),),
    )


def pressure_alone():
    heard = [only(each, "pressure") for each in (run(HUM), run(), run(HUM))]
    return base(
        ("mains_hum",),
        location=replace(PLACE, stage="measurement", channels=("pressure",), band=(40.0, 160.0),
                         phase="all", conditions="all"),
        stages={"measurement": StageFinding(5.0, 1.0, 1e-6)},
        effects=(EffectFinding("mains_hum", "measurement", 0.7),),
        probabilities={"mains_hum": 0.7, "room_reflections": 0.2, "parameters": 0.1},
        parameters={},
        held_out=(),
        notes=("Pressure alone: friction and structure cannot be looked at by themselves.",),
        illustrations=(illustration("only.wav", *heard),),
    )  # fmt: skip


def triple():
    names = ("critical_torque_scatter", "velocity_strengthening", "viscoelastic_stiffness")
    found = tuple(
        EffectFinding(name, "friction", 0.8, gap_before=1.5, gap_after=1.2 + 0.1 * i)
        for i, name in enumerate(names)
    )
    return base(
        names,
        effects=found,
        probabilities=dict.fromkeys(names, 0.8),
        held_out=tuple(f"run{i:02d}" for i in range(12)),
        gap=1.5,
    )


KINDS = {
    "none": none,
    "parameters": parameters,
    "one effect": one_effect,
    "pair": pair,
    "triple": triple,
    "unknown": unknown,
    "pressure alone": pressure_alone,
}
