"""EMG and BCI interfaces: decoded labels, their debouncing, and the commands they give."""
