"""Compare model and measurement, see where it fails, name the missing effect, add it."""
