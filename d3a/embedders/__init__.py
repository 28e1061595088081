"""Embedders: what turns the picture of a thing into numbers that can be compared."""
