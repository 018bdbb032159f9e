"""The distance between recorded and simulated signals, in units of what repeats differ by."""
