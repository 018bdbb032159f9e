"""Calibration of the shipped fluorocarbon: ``python -m noise.training.calibrate``.

What is unknown of contact and damping (`unknowns`) is identified from the thesis's numbers
(`thesis_table`), and again with one of the six critical speeds at 0.279 mm left out at a time, to
see what the model predicts unfitted (`report`).
"""
