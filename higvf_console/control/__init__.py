"""The paper, compiled: no clock, files, randomness, threads or user interface. Start with `controller`."""
