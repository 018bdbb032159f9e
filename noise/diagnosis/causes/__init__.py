"""Causes of a gap: posterior probabilities, location and verdict."""
