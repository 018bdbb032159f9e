"""Rig, structure and radiation: from the torque in the bushing to the sound at the microphone."""

import lazy_loader

from models.compile_cache import ensure_compile_cache

# What is exported stands once, in the stub beside this file; it is loaded when it is first used.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

ensure_compile_cache()
