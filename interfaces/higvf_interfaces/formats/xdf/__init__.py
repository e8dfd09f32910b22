"""Readers of XDF files (Lab Streaming Layer)."""
