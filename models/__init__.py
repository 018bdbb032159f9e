"""Rig, structure and radiation: from the torque in the bushing to the sound at the microphone."""
