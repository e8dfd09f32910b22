"""Intentions: what each robot wants, what the team shares, how formation and human are blended in."""
