"""Scripts that play logs in what was exported; each runs alone, and imports nothing of ours."""
