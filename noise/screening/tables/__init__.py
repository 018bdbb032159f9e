"""The tables that a screen writes."""
