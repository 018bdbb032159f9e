"""Identification of a rig from recordings: stiffness, damping, torques, the law of friction."""
