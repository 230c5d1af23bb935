"""Fit the model's numbers to measurements, with honest intervals."""
