"""The thesis's own gap: which missing effect brings its constant torques to its measured tables."""
