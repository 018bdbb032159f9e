"""A slider pulled through a spring, and the friction term that its force records ask for.

Stick-slip forgets its phase, so records and simulations are compared by the statistics of their
force cycles, each in units of what the record's own blocks differ by.
"""

from tests.studies.pulled_slider.compare import SliderComparison, compare_slider
from tests.studies.pulled_slider.cycles import FEATURES, cycle_features
from tests.studies.pulled_slider.identified import IdentifiedSlider, identify_slider
from tests.studies.pulled_slider.law import SLIDER_TERMS, Slider, SliderTerm
from tests.studies.pulled_slider.record import PulledRecord, read_pulled_record

__all__ = [
    "FEATURES",
    "SLIDER_TERMS",
    "IdentifiedSlider",
    "PulledRecord",
    "Slider",
    "SliderComparison",
    "SliderTerm",
    "compare_slider",
    "cycle_features",
    "identify_slider",
    "read_pulled_record",
]
