"""Clamp, beams, plate and shaft: their modes and responses."""
