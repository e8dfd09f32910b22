"""Cards over the arena: before a run, after it, and the scenarios to choose from."""
