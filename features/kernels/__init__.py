"""Computations behind the features: spectra, bands, lines, harmonics, slips, levels."""
