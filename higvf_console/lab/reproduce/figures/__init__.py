"""The figures of the report, in one visual language."""
