"""Effects that act at the winch."""
