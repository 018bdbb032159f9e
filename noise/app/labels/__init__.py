"""Of the app: recordings as a list, their labels, corrections."""
