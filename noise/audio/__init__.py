"""Recordings as audible sound with known levels.

`sound` makes it, `gain` decides how loud, `assessment` says what its levels are, `render` writes
sets of files, `spectrogram` is what is seen of it.
"""
