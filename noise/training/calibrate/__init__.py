"""Calibration of the shipped fluorocarbon: ``python -m noise.training.calibrate``.

What is unknown of contact and damping (`unknowns`) is searched (`search`) so that the regimes and
noises of Section 5 come out (`cells`, `objective`), and the search is repeated with one of the six
critical speeds at 0.279 mm left out at a time, to see what the model predicts unfitted (`report`).
"""
