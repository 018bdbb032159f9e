"""Self-contained HTML pages with sounds."""
