"""The world that the controller acts in: operator commands, fires, dynamics, metrics."""
