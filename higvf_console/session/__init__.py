"""A run: scenario, clock, inputs, recording."""
