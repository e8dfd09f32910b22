"""Adapters from devices and recordings to operator commands."""
