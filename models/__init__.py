"""Rig, structure and radiation: from the torque in the bushing to the sound at the microphone."""

from models.compilation import ensure_compile_cache

ensure_compile_cache()
