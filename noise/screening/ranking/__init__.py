"""Designs compared: margins to the use, risk numbers, the ranking."""
