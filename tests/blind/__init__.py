"""The blind check: a second rig seen by somebody else, cases made with it, answers kept apart.

Nothing that makes cases imports `models`, `sim`, `features` or `noise`, and none of them imports
this: an examiner who shares code with the candidate also shares its errors. Of the score one
module, `score.floors`, may use the distance of `noise`, where asked to.
"""
