"""Colour words scored against colour histograms at query time (DESIGN, decision 5)."""

from d3a.colours.judge import LEAST_ODDS, Appearances, Verdict, learn
from d3a.colours.looks import HISTOGRAM_SIZE, carries_histogram, histograms
from d3a.colours.names import BASIC, colours_of, is_colour, words_of
from d3a.colours.pixels import Palette

__all__ = [
    "BASIC",
    "HISTOGRAM_SIZE",
    "LEAST_ODDS",
    "Appearances",
    "Palette",
    "Verdict",
    "carries_histogram",
    "colours_of",
    "histograms",
    "is_colour",
    "learn",
    "words_of",
]
