"""Recordings as audible sound: for listening, and with a level that can be checked.

`sound` makes it, `gain` decides how loud, `assessment` says what its levels are, `render` writes
sets of files, `spectrogram` is what is seen of it.
"""
