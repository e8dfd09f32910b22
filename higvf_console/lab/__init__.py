"""Benchmarks, the fit of Table II and the reproduction of the paper, all headless."""
