"""Integration of the equations of motion: exact stick-slip, contacts with inner state."""
