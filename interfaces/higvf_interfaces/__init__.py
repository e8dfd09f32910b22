"""Operator interfaces: adapters that turn devices and recordings into operator commands."""
