"""Effects that act from outside."""
