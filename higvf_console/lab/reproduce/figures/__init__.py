"""The figures of the report, in one common style."""
