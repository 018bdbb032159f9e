"""Modal analysis: hammer hits, response estimates, fitted modes."""
