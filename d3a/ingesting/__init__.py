"""On the way to the associator: which frames are taken in, made ready, and what is noted."""
