"""What a recording says of contact, channels and transfer paths, as named numbers."""
