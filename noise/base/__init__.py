"""Foundations of every part of the program: whole files, tables, models, trees, progress."""
