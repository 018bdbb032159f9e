"""Recordings made ready: the settled part, the speed as it was, and the sensors' noise."""
