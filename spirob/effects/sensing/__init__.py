"""Effects that act in sensing."""
