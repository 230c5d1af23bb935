"""Effects that act at the motor."""
