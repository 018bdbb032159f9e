"""Drawn cases: rigs, structures, effects and conditions as a posterior learns from them."""
