"""One panel per file; each is built once and updated with every snapshot."""
