"""Pictures of runs, recordings, maps and figures of the thesis.

Functions here return matplotlib figures and never touch pyplot, so that a program that draws
pictures of its own keeps its settings; `noise.pictures.figure` writes them. Nothing that draws is
imported before it is called.
"""
