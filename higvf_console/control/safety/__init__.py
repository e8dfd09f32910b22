"""The safety filter: the velocity nearest to the nominal one under all barrier constraints."""
