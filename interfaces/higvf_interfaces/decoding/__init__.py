"""Decoders of raw EMG and EEG signals, and their evaluation; also examples for decoders of your own."""
