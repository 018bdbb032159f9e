"""Features of friction noise: spectra, bands, lines, harmonics and slips.

Each has a function and a frozen result; `feature_vector` and `recording_features` combine the
features that distinguish noises.
"""

import lazy_loader

import models  # noqa: F401  # sets the folder for compiled code

# Exports are listed once, in the stub beside this file, and loaded at first use.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
