"""What an answer must say beside itself: how sure it is and why, and what it could not judge."""

from __future__ import annotations

import re

from assistant.amounts import holds
from assistant.conditions import gathered_words
from assistant.each import asks_for_each
from assistant.english import counted, listed, number_word, plural, times
from assistant.phrases import (
    at_place,
    definite,
    heads_of,
    likely_of,
    newest_of,
    numbered,
    term_of,
    theirs,
    wider_kind,
)
from assistant.said import said_many
from assistant.wording import how_sure
from d3a.answer import Answer, RankedKeyframe, is_by_look
from d3a.answering.match import said_alone
from grammar.forms import ANYTHING, FormalQuery, ObjectTerm


def is_open(query: FormalQuery) -> bool:
    """Whether the kinds found are news: anything was asked for, or several things at once."""
    several = query.relation is None and len(query.objects) > 1
    return several or term_of(query).category == ANYTHING


def sureness(answer: Answer, query: FormalQuery) -> str:
    """Return how sure the best keyframe is, in words with the reason."""
    best, quantity = answer.keyframes[0], term_of(query).quantity
    if query.ask not in ("whether", "where", "when") or query.select == "usual":
        return ""
    point = query.time is not None and query.time.is_point
    if (
        point
        or answer.otherwise is not None
        or is_open(query)
        or (quantity is not None and not (answer.query and holds(answer, query)))
    ):
        return ""
    if is_by_look(best.object_id):
        return "It looks like it: I know it by its colours alone."
    said = sure_words(best)
    rivals = [k for k in heads_of(answer)[1:] if k.object_id != best.object_id]
    close = [k for k in rivals if k.score >= 0.8 * best.score]
    if query.ask == "where" and query.select == "last" and asks_for_each(answer, query):
        return ""  # where each is
    if query.ask == "where" and close and not gathered_words(answer, query):
        number = len({k.object_id for k in close})
        if answer.least == 1:  # all of them may be it, at another place and time
            return f"What I saw at {counted(number, 'other place')} may be the same."
        return others_words(number, said_many(query, term_of(query)))
    return f"{said}: {_seen(answer, query, best)}."


def sure_words(keyframe: RankedKeyframe) -> str:
    """Return how sure a keyframe is, as the beginning of a sentence."""
    band = how_sure(keyframe)
    return "This is a guess" if band == "a guess" else f"I am {band}"


def _seen(answer: Answer, query: FormalQuery, best: RankedKeyframe) -> str:
    """Return how often the best was seen, as its row says it, and there in all.

    Where another row is told, the number of one is no reason; where all likely ones are told as
    so many occasions, they count together.
    """
    views = max(int(best.why.get("views", best.seen)), best.seen)
    if query.ask != "where" and query.select == "all":
        views = max(views, sum(keyframe.seen for keyframe in likely_of(answer)))
    told = best.within is None and (query.ask == "where" or newest_of(answer) == best)
    if views == best.seen and best.within is None:
        return f"seen {times(views)}"
    return (
        f"seen {times(best.seen)} then, {times(views)} in all"
        if told
        else (f"seen {times(views)} in all")
    )


def others_words(number: int, many: bool) -> str:
    """Return how many things as likely there are: which one is meant, they cannot tell."""
    verb = "is" if number == 1 else "are"
    return f"There {verb} {number_word(number)} more {'they' if many else 'it'} could be."


def left_out(answer: Answer) -> str:
    """Return what this memory cannot tell of the question; empty where it could judge all."""
    if not answer.unjudged:
        return ""
    place = answer.query.place if answer.query is not None else None
    terms = answer.query.terms if answer.query is not None else ()
    owners = dict.fromkeys(term.owner for term in terms if term.owner)
    untold = [owner for owner in owners if said_alone(owner) in answer.unjudged]
    rest = [w for w in answer.unjudged if w not in {said_alone(owner) for owner in untold}]
    kinds = [which_words(answer, term) for term in terms]
    rest = [w for w in rest if w not in {term.word for term in terms if wider_kind(answer, term)}]
    told = [at_place(place) if place and w == f"in the {place}" else w for w in rest]
    spoken = [re.sub(r"\d+$", lambda m: number_word(int(m[0])), words) for words in told]
    whose = f"Nobody told me what is {listed([theirs(owner) for owner in untold])}."
    left = f"I cannot tell what is {listed([f'“{words}”' for words in spoken])} here."
    left_over = [*[whose] * bool(untold), *[left] * bool(spoken)]
    return " ".join([*left_over, *dict.fromkeys(words for words in kinds if words)])


def which_words(answer: Answer, term: ObjectTerm) -> str:
    """Return that a thing was found by a wider word alone: which bottle is the water bottle."""
    kind = wider_kind(answer, term)
    if not kind or answer.query is None:
        return ""
    many = said_many(answer.query, term)
    said, found = numbered(answer.query, term), plural(kind) if many else kind
    asked = said if many and not term.owner else definite(term, said)
    return f"I cannot tell which {found} {'are' if many else 'is'} {asked}."
