"""Radiation: from forces on plate and beams to sound pressure and sound power."""
