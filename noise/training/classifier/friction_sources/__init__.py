"""Friction that creaks, squawks and squeals in other bodies than the bushing.

The classifier that knows one rig's sound alone takes a door for any other sound. What makes a creak
or a squeal is not the rig but friction: slips that strike a body, a force that is heard as it is,
or a mode that friction feeds. Here are these mechanisms, on bodies and drives drawn at random, in
SI units but for the level, which is arbitrary; the bodies are rows of ``friction_sounds.toml``.
"""
