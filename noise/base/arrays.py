"""Types of arrays that most signatures have."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
