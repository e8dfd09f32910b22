"""Decoders of raw EMG and EEG: chunks of samples in, decisions out; worked examples for decoders of your own."""
