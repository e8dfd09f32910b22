"""The paper, compiled; start with `controller`.

No clock, threads, randomness or user interface; no files but for the cache of machine code (`kernel`, `compilation`).
"""
