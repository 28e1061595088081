"""What people taught, said back in their own words: Excalibur, your keys.

The store's names are as formal queries have them, small and singular; how a name was said stands
in the history of what was taught, for as long as that holds.
"""

from __future__ import annotations

from dataclasses import replace

from assistant.english import sentence_case
from assistant.phrases import is_kind
from d3a.answering.facts import Facts
from d3a.answering.match import squash
from grammar.forms import FormalQuery, ObjectTerm

_ARTICLES = ("the", "a", "an")


def said_back(heard: str, kind: str) -> str:
    """Return a name as the robot says it: my keys are your keys; kind: of the thing, for "mine"."""
    first, _, rest = heard.partition(" ")
    small = first.lower()
    if small in ("my", "our"):
        return f"your {rest}"
    if heard.lower() in ("mine", "ours"):
        return f"your {kind}"
    if small.endswith(("'s", "s'")):
        return f"{sentence_case(first)} {rest or kind}"
    return _bare(heard)


def as_heard(query: FormalQuery, facts: Facts) -> FormalQuery:
    """Return the query with the names that were taught for its things written as they were said.

    Raises StoreError.
    """
    taught = {squash(name.word) for name in facts.names() if name.owner is None}
    if not any(squash(term.word) in taught for term in query.objects):
        return query
    from d3a.constraints import History  # most questions do without

    heard = [each.arguments.get("heard") for each in History.read(facts).entries]
    written = {squash(_bare(name)): _written(name) for name in heard if name}
    return replace(query, objects=tuple(_spelled(term, written) for term in query.objects))


def _spelled(term: ObjectTerm, written: dict[str, str]) -> ObjectTerm:
    word = written.get(squash(term.word)) if term.owner is None else None
    return term if word is None else replace(term, word=word)


def _written(heard: str) -> str:
    """Return a name without its article; one that had none, and is no kind of thing, is a name."""
    bare = _bare(heard)
    return sentence_case(bare) if bare == heard and not is_kind(bare) else bare


def _bare(heard: str) -> str:
    first, _, rest = heard.partition(" ")
    return rest if rest and first.lower() in _ARTICLES else heard
