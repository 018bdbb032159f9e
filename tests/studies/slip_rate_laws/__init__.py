"""Friction laws for the slip rate at 0.381 mm: prototypes, as compared in `slip_rate_laws.md`."""
