"""Effects that act at the tendon."""
