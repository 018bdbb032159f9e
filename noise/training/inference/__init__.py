"""Training of the shipped model that infers operating conditions from a segment."""
