"""From a signal to the numbers that an NVH engineer reads.

Spectra, bands, lines, harmonics and slip events each have a function and a frozen result of their
own; `feature_vector` and `recording_features` gather what tells one noise from another.
"""

import lazy_loader

import models  # noqa: F401  # which names the folder for compiled code

# What is exported stands once, in the stub beside this file; it is loaded when it is first used.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
