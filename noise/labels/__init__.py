"""Labelling of recordings: segments with labels, and the label table with operating conditions."""
