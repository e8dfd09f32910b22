"""Guidance: desired paths, progress along them, circulation round obstacles, deadlock recovery."""
