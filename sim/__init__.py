"""The simulator: from how the shaft turns to what the sensors record."""

import lazy_loader

import models  # noqa: F401  # which names the folder for compiled code

# What is exported stands once, in the stub beside this file; it is loaded when it is first used.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
