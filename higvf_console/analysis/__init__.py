"""Explanations of a run: parts of a velocity, lines of sight, active constraints, previews, the baseline."""
