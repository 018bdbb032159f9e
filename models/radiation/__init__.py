"""From forces to sound pressure and sound power."""
