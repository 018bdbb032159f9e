"""What is screened: a design, its use, its environments and its tolerances."""
