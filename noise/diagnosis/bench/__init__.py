"""Whether recordings can be of the rig that its file describes: units, signs, order, conditions.

The thresholds are assumed where they do not say otherwise; together they find nothing in any of 82
right development cases of the second rig, with and without causes (seed 3: quiet, sensors, starts,
records, laws and together; seed 4: quiet, sensors and laws).
"""
