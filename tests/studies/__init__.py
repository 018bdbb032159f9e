"""Evidence that no command reaches: what was measured on records of other rigs, and how."""
