"""Of the app: sounds compared blind."""
