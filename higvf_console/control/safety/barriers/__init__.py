"""Safety barriers: each module turns one kind of danger into rows a.v <= b on a robot's velocity."""
