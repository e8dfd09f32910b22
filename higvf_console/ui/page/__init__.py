"""The browser page: who may reach it, who steers, and the scripts that run in it."""
