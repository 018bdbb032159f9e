"""Synthetic creaks, squawks and squeals of other bodies than the bushing.

A classifier trained on one rig would label a door as unknown. Creaks and squeals arise from
friction in any body: slips that strike it, a friction force that is radiated, or a mode excited by
friction. These mechanisms act on random bodies with random drives, in SI units but for the
arbitrary level. The bodies are rows of ``friction_sounds.toml``.
"""
