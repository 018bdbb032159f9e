"""Training of the shipped models; only the command `train` imports it."""
