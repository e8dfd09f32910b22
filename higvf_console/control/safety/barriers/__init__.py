"""Safety barriers: each module makes the linear constraint a.v <= b of one kind of hazard."""
