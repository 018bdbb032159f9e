"""The map of a design: points over speed, interference and support, simulated and refined."""
