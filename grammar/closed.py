"""The closed class: function words and verbs of the grammar; every other word is open."""

from __future__ import annotations

from grammar.numbers import CARDINALS


def words_of(text: str) -> frozenset[str]:
    """Return the words of a text as a set."""
    return frozenset(text.split())


CLOSED = words_of(
    "a an the this that these those some any no not never none all every each both either "
    "another i you he she it we they me him her us them my your his its our their mine yours "
    "ours theirs hers who whom whose what which where when why how whether if is are was were "
    "am be been being do does did done have has had having can could may might must shall "
    "should will would and or but nor so because although while than as at by for from in into "
    "of off on onto out over to under up upon with within without about above across after "
    "against along among around before behind below beneath beside besides between beyond down "
    "during except inside near next outside since through throughout till toward towards "
    "underneath until there here then now just still already yet ever again also too even only "
    "enough please one ones many much more most fewer least twice see saw seen seeing look looked "
    "find found leave left put lost last spotted noticed placed show list tell "
)
"""Words that never are part of a noun phrase's open words."""


LEADING = words_of("the a an my your our his her their its this that these those")
"""What leads a noun phrase that names its thing."""


def is_open(word: str) -> bool:
    """Whether a word may belong to a noun phrase: no function word, mark or number."""
    return word[:1].isalpha() and word not in CLOSED and word not in CARDINALS
