"""The frequency that a segment is told to have."""

import numpy as np

from noise.labels.classified import FREQUENCY_NAMES, segment_frequency


def test_one_window_whose_torque_seems_periodic_does_not_tell_the_frequency_of_seven():
    features = np.full((7, len(FREQUENCY_NAMES)), np.nan, dtype=np.float32)
    features[3, FREQUENCY_NAMES.index("torque_fundamental")] = 5.8
    features[:, FREQUENCY_NAMES.index("pressure_high_period_strength")] = 0.5
    features[:, FREQUENCY_NAMES.index("pressure_high_period_rate")] = 2.5
    found = segment_frequency(features, "creak")
    assert found is not None
    assert found > 40.0

    features[:, FREQUENCY_NAMES.index("torque_fundamental")] = 54.0
    assert segment_frequency(features, "creak") == 54.0
