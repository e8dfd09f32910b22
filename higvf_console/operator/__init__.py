"""Applies operator commands: pure functions from state and command to the next state."""
