"""What panels are made of: shared widgets, groups of widgets, charts and tables."""
