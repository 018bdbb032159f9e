"""Sentences of a diagnosis."""
