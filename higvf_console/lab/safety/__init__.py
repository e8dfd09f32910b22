"""The search for a broken guarantee: random worlds and commands, checked at every control period."""
