"""Edits of a running world: what it is made of, where things may stand, what an edit does, how it is undone."""
