"""A condition is known as a whole, or what it lacks is said at once."""

from dataclasses import replace

import numpy as np
import pytest

from models.condition import FIXED, Condition, KnownCondition, known_condition
from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.diagnosis.simulated.nominal import condition_key

WHOLE = Condition(2.5, 0.279e-3, FIXED, material="PDMS", temperature=30.0)


def test_a_known_condition_keeps_all_that_was_stated():
    known = known_condition(WHOLE)
    assert known == KnownCondition(2.5, 0.279e-3, FIXED, "PDMS", 30.0)
    assert known_condition(known) is known
    assert known.words == WHOLE.words


@pytest.mark.parametrize(
    ("field", "said"),
    [
        ("speed", r"speed \[rad/s\]"),
        ("interference", r"interference \[m\]"),
        ("support_stiffness", r"support stiffness \[Nm/rad\]"),
    ],
)
def test_what_is_missing_is_named(field, said):
    with pytest.raises(ParameterError, match=f"states no {said};"):
        known_condition(replace(WHOLE, **{field: None}))


def test_a_recording_of_an_unknown_condition_has_no_repeats():
    recording = Recording(np.zeros((1, 99)), 30e3, (Channel("torque"),), replace(WHOLE, speed=None))
    with pytest.raises(ParameterError, match="states no speed"):
        condition_key(recording)
