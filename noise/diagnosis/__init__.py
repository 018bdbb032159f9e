"""Diagnosis of the difference between recordings and simulation: missing effects and their share.

A number that decides something says where it comes from. What is "assumed" was chosen by judgement
when it was written, and no measurement of it is on record; what such choices do together is what
the exam of the second rig measures (`tests/blind/README.md`).
"""
