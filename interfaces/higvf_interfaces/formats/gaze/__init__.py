"""Readers of eye-tracker files."""
