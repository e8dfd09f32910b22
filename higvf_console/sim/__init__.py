"""The world that the controller acts in: the step, fires, dynamics, metrics."""
