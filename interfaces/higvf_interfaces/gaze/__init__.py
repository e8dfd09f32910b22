"""Gaze as operator input: recordings, fixations, calibration, attention."""
