"""One panel, one file, three verbs: build, update, clean up."""
