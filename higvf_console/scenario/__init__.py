"""Scenario files: strict YAML, read into a run and written back."""
