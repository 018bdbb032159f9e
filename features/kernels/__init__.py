"""The calculations that features rest on: spectra, bands, lines, harmonics, slips, levels."""
