"""A stabilizer bar in two bushings: motion, normal load, recording."""
