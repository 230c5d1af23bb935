"""Effects that act at the body."""
