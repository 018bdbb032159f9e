"""A screen as a page: the designs ranked, their maps side by side, what differs, and sounds."""
