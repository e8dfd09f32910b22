"""What each operator command means: pure functions from state to state."""
