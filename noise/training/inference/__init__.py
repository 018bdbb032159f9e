"""The recipe and the fit of the shipped model that infers conditions from a segment."""
