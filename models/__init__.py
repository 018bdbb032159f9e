"""Rig, structure and radiation: from the torque in the bushing to the sound at the microphone."""

import lazy_loader

# What is exported stands once, in the stub beside this file; it is loaded when it is first used.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
