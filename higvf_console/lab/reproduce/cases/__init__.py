"""The cases: each file runs a few of them and compares them with what the paper says."""
