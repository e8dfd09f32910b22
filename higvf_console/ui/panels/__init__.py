"""One panel, one file, two verbs: build and update."""
