"""Features of signals too long to be held in memory, summed up while they are read."""
