"""Type aliases of most signatures: an array of floats, a generator of random numbers."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rng = np.random.Generator
