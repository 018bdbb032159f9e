"""The term that a measured oscillator has and its linear model lacks.

A driven, damped oscillator does not forget its phase as stick-slip does, so the distance between
measurement and simulation is here the plain rms error of a free-run simulation. A linear model is
found on quiet data, recalibrated on loud data, and given one term of a library at a time, all its
parameters refitted with it; the terms are ranked on data that no fit has seen.

>>> from tests.studies.oscillator_terms import LIBRARY
>>> [term.name for term in LIBRARY][:3]
['quadratic_stiffness', 'cubic_stiffness', 'coulomb_friction']
"""

from tests.studies.oscillator_terms.diagnose import diagnose_oscillator
from tests.studies.oscillator_terms.finding import Gap, OscillatorDiagnosis, TermFinding
from tests.studies.oscillator_terms.oscillator import DrivenRecord, Oscillator
from tests.studies.oscillator_terms.registry import LIBRARY, Term

__all__ = [
    "LIBRARY",
    "DrivenRecord",
    "Gap",
    "Oscillator",
    "OscillatorDiagnosis",
    "Term",
    "TermFinding",
    "diagnose_oscillator",
]
