"""Strict reading of YAML and of options: `node` checks values at their place, `document` reads and writes YAML."""
