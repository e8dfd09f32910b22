"""Gaze interface: playback, fixation detection, calibration, attention measures."""
