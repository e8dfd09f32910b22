"""Decoded decisions (EMG, BCI) as operator commands."""
