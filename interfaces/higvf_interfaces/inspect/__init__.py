"""What a file is, and what it would become as operator input."""
