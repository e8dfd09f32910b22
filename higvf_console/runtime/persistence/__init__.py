"""What a console keeps on disk while it runs, for the next one: the run, and the edited world."""
