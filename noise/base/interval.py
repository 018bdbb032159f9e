"""The 90 % interval of a normal distribution."""

from __future__ import annotations

SURE_90 = 1.645
"""So many standard deviations to either side hold 90 % [-]."""
