"""Words: categories, synonyms, broader and narrower words, plurals.

The functions work on the vocabulary files alone; `lexicon(words)` adds a store's own words.
"""

from grammar.vocabulary.lexicon import Lexicon, StoreWords, lexicon
from grammar.vocabulary.words import (
    broader,
    canonical,
    narrower,
    plural,
    singular,
    synonyms,
    unlisted_lead,
)

__all__ = [
    "Lexicon",
    "StoreWords",
    "broader",
    "canonical",
    "lexicon",
    "narrower",
    "plural",
    "singular",
    "synonyms",
    "unlisted_lead",
]
