"""Models of rig, structure and radiation: from the bushing's torque to the sound pressure."""

from models.compilation import ensure_compile_cache

ensure_compile_cache()
