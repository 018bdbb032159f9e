"""Long runs of `sim.run` and their labels: what maps and advice are judged by.

They share no code with `noise.screening`: one run from rest, or through speeds at which it
vibrates, for as long as asked, as a user would do it by ``simulate --speed FILE.csv`` and
``label``.
"""

import numpy as np

from noise.classifier import load_classifier
from noise.labels.segments import file_label, label_recording
from sim.motion import simulate_motion
from sim.run import simulate
from sim.shaft import LoggedSpeed
from sim.temperature import at_temperature

HELD = 1.0
"""How long each speed before the last is held [s]."""

JUDGED = 1.0
"""Of the end [s]."""


def through(speeds, seconds, ramp=0.05):
    """A shaft that turns at each speed, and `seconds` at the last."""
    held = [(HELD, speed) for speed in speeds[:-1]] + [(seconds, speeds[-1])]
    time, logged, now = [], [], 0.0
    for length, speed in held:
        time += [now, now + length]
        logged += [speed, speed]
        now += length + ramp
    return LoggedSpeed(time, logged), time[-1]


def vibrates_after(rig, at, speeds, *, seconds, ramp=0.05):
    """Whether the torque still oscillates by a hundredth of its mean at the end."""
    shaft, length = through(speeds, seconds, ramp)
    motion = simulate_motion(
        at_temperature(rig, at.temperature), shaft, interference=at.interference,
        support_stiffness=at.support_stiffness, seconds=length, rate=15e3,
    )  # fmt: skip
    torque = motion.torque[-round(JUDGED * motion.rate) :]
    return bool(np.std(torque) > 0.01 * abs(np.mean(torque)))


def label_after(rig, at, speeds, *, seconds):
    """What ``label`` calls the last second."""
    shaft, length = through(speeds, seconds)
    run = simulate(
        rig, shaft, interference=at.interference, support_stiffness=at.support_stiffness,
        temperature=at.temperature, seconds=JUDGED, settling=length - JUDGED,
        rng=np.random.default_rng(9),
    )  # fmt: skip
    return file_label(label_recording(run.recording, load_classifier())).label
