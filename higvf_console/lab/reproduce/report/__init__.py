"""The report of a reproduction as an HTML page, Markdown with figures, and JSON."""
