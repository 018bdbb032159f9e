"""Pictures as the thesis draws them: of one run, and of sweeps and slips beside its measurements.

Functions here return matplotlib figures and never touch pyplot, so that a program that draws
pictures of its own keeps its settings; `noise.pictures.figure` writes them. Nothing that draws is
imported before it is called.
"""
