"""Recordings as audible sound: for listening, and with a level that can be checked.

`sound` makes it, `gain` decides how loud, `sequence` puts sounds behind one another, `wav` and
`files` write it, `assessment` says what its levels are.
"""
