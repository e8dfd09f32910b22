"""Readers of gaze formats, one module per format; each yields a `GazeStream`."""
