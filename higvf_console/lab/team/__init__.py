"""Teams against physics that is not ours: the plant of Enki, the suite `team`."""
