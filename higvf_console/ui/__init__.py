"""The browser console on viser."""
