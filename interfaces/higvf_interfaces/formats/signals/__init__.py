"""Readers of EMG and EEG files."""
