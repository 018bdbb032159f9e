"""Transfer functions, modelled or measured, and their files."""
