"""Foundations of every part of the program: whole files, tables, models, trees, progress."""

SURE_90 = 1.645
"""So many standard deviations of a normal distribution to either side hold 90 % [-]."""
