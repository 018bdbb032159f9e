"""Named numbers of contact, channels and transfer paths, and a case as one row of them."""
