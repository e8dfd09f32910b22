"""The arena as the operator sees it, layer by layer."""
