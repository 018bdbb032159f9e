"""Table of the thesis's numbers beside what the program computes, with a verdict a row.

Numbers come in groups by theme, one file each; `noise.thesis.table` lists the groups,
`noise.thesis.row` decides the verdicts.
"""
