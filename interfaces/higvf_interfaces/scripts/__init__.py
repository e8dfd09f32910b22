"""Scripts of operator actions as an interface."""
