"""What the operator does in the arena: pointer, tools, keys, camera."""
