"""Edits of the layout during a run: the entities, where they may stand, what each edit does, what it must keep."""
