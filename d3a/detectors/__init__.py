"""Detectors: what names the things in a frame."""
