"""Features of many overlapping windows of a sound at once, made for labelling hours of it."""
