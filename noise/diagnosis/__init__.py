"""Why a recording differs from its simulation: which effect is missing, and how far it closes.

A number that decides something says where it comes from. What is "assumed" was chosen by judgement
when it was written, and no measurement of it is on record; what such choices do together is what
the exam of the second rig measures (`tests/blind/README.md`).
"""
