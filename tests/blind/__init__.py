"""The blind check: a second rig seen by somebody else, cases made with it, answers kept apart.

Nothing here imports `models`, `sim`, `features` or `noise`, and none of them imports this: an
examiner who shares code with the candidate also shares its errors.
"""
