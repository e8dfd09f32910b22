"""Guiding vector fields: desired paths, progress along them, the way round obstacles, recovery from deadlock."""
