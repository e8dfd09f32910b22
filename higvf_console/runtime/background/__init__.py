"""What runs beside the session's loop, in threads and a process of its own, so that nothing holds the team up."""
