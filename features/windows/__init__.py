"""Features of many overlapping windows of a sound at once, for hours of sound."""
