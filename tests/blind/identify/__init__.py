"""Rigs of the second simulator with six friction laws, for checking `bushing-noise identify`."""
