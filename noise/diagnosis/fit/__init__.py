"""Fits of parameters and effects to recordings, scored on recordings left out."""
