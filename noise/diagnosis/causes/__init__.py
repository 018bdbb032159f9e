"""Which cause: posterior, location, equivalence, verdict."""
