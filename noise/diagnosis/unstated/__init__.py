"""Conditions that a sidecar leaves out: told by angle and torque, or asked of the user."""
