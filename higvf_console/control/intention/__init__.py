"""Intentions: perception and robot intention, shared intention, formation, blending, messages."""
