"""The fit of Table II: `higvf fit`."""
