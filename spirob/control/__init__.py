"""Feedback laws that turn a reference and the drive's feedback into a current command."""
