"""HI-GVF console: one person guides a team of robots from the browser."""
