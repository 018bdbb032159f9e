"""The recipe and the fit of the shipped classifier: sounds, microphones, trees, operating point."""
