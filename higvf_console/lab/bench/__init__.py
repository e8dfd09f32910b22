"""Benchmarks: `higvf bench --suite NAME`."""
