"""File inspection for `higvf inspect`: format, contents, and conversion to operator commands."""
