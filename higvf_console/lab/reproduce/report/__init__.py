"""The report of a reproduction: one HTML page, Markdown with pictures beside it, and JSON."""
