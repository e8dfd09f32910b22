"""Operator channels: interfaces found by entry point, polled, supervised, put out of service when they fail."""
