"""Identification of a rig from recordings: stiffness, damping, torques, the law of friction.

What is "assumed" was chosen by judgement when it was written, and no measurement of it is on
record; what such choices do together is measured by `python -m tests.blind identify`.
"""
