"""Runs of the rig under diagnosis: nominal, scattered, with effects."""
