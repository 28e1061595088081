"""Readers: one module a kind of recording; `d3a.readers.opening` knows each by looking."""
