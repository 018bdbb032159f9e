"""Rig files: what a TOML file says of a rig."""
