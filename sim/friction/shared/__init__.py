"""Parts that several friction laws have in common."""
