"""The names of the labels, in the one order that all tables and models have."""

from __future__ import annotations

__all__ = ["LABELS", "NAMED"]

LABELS = ("creak", "squawk", "squeal", "none", "unknown")
"""The labels, in the order of all tables of probabilities."""

NAMED = LABELS[:3]
"""Those that are the name of a noise."""
