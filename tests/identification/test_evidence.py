"""Evidence from elsewhere than stick-slip joins numbers by how sure it is."""

import math

import pytest

from noise.identification.evidence import Evidence, elastomer_stiffness, with_evidence
from noise.identification.outcome import Number


def test_a_stiffness_in_series_with_beams_says_that_of_the_elastomer():
    series = 1.0 / (1.0 / 665.0 + 1.0 / 2214.0)
    stiffness, gain = elastomer_stiffness(series, 2214.0)
    assert stiffness == pytest.approx(665.0)
    assert gain > 1.0  # the beams' own compliance says nothing of the elastomer


def test_evidence_draws_a_number_to_it_by_how_sure_it_is():
    slips = Number("elastomer_stiffness", "Nm/rad", 600.0, 540.0, 667.0, 6, 0.279e-3)
    (sure,) = with_evidence([slips], [Evidence("elastomer_stiffness", 630.0, 0.001, 0.279e-3)])
    (vague,) = with_evidence([slips], [Evidence("elastomer_stiffness", 630.0, 0.5, 0.279e-3)])
    assert 615.0 < sure.value < 630.0
    assert vague.value == pytest.approx(600.0, rel=0.01)
    assert math.log(sure.high / sure.low) < math.log(slips.high / slips.low)


def test_contradicting_evidence_makes_a_number_less_sure_than_agreeing():
    slips = Number("elastomer_stiffness", "Nm/rad", 600.0, 588.0, 612.0, 6, 0.279e-3)
    agrees, contradicts = (
        with_evidence([slips], [Evidence("elastomer_stiffness", k, 0.01, 0.279e-3)])[0]
        for k in (602.0, 700.0)
    )
    assert contradicts.high / contradicts.low > agrees.high / agrees.low
