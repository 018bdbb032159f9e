"""Preparation of recordings: settled part, measured speed and noise of the sensors."""
