"""Effects: the smallest set of effects that an accuracy calls for."""
