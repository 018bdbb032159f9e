"""The score: what a diagnosis said of blind cases, beside what was the matter with them.

Quantities are rows of numbers, one a case, and a statistic of them, so that one bootstrap over
cases serves all. A diagnosis that failed counts against every quantity, false alarms included.
"""
