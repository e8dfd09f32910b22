"""Benchmarks and studies: headless users of a session."""
