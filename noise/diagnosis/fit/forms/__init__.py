"""Further forms of effects for a case: drawn from the library, or estimated from its recordings."""
