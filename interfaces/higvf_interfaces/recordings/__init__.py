"""Generators of synthetic recordings: `python -m higvf_interfaces.recordings OUT_DIR --plan PLAN.yaml`."""
