"""Damaged and hostile files for every reader and every command that takes a file.

A few thousand run with the tests; ``python -m tests.fuzz --inputs 100000`` runs as many as are
wanted and says what came of them. Each input is told by a seed and a number, so that a finding is
made again by ``--seed S --first N --inputs 1``, and ``--keep FILE`` writes its line for
``corpus.jsonl``: what ever failed, which is tried in each run of the tests.
"""
