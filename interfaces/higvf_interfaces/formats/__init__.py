"""Readers of recorded files. `reading` and `signals.reading` detect the format from the content and read the file."""
