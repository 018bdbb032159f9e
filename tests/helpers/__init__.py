"""Signals, rigs and files that several tests share."""
