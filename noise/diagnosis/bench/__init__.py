"""Checks that recordings fit the rig file: units, signs, channels and conditions.

Thresholds are assumed unless stated otherwise. Together they give no finding in any of 82 correct
development cases of the second rig, with and without causes (seed 3: quiet, sensors, starts,
records, laws and together; seed 4: quiet, sensors and laws).
"""
