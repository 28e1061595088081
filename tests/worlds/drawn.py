"""Homes and formal queries that hypothesis draws, for stores that must give the same answers.

Few kinds, places and minutes on purpose: so that slices cut intervals, things tie, and relations
hold here and not there.
"""

from __future__ import annotations

from hypothesis import strategies as st

from grammar.forms import (
    ANYTHING,
    ASKS,
    BOUNDS,
    FormalQuery,
    ObjectTerm,
    Relation,
    TimeSlice,
    Where,
)
from tests.worlds.made import PAINTS, Home, at

KINDS = ("cup", "bowl", "table", "sports ball", "couch")
WORDS = (*KINDS, "mug", "keys", "ball", "elephant", ANYTHING)
RELATIONS = ("together", "near", "on", "under", "in", "left_of", "same_place", "between")
ROOMS = ("kitchen", "office")
PROBABILITIES = (0.35, 0.6, 0.9)
minutes = st.integers(-6, 12).map(lambda n: n * 20.0)
spots = st.none() | st.tuples(
    st.sampled_from((-1.0, 0.0, 0.4, 2.0, 5.0)), st.sampled_from((0.0, 1.0)), st.just(0.5)
)
corner = st.sampled_from((0.0, 40.0, 90.0))


@st.composite
def boxes(draw: st.DrawFn) -> tuple[float, float, float, float]:
    x, y = draw(corner), draw(corner)
    return x, y, x + 50.0, y + 60.0


@st.composite
def homes(draw: st.DrawFn) -> Home:
    """Draw up to six things with up to five sightings each, and what was seen together."""
    home = Home(seed=draw(st.integers(0, 3)))
    home.classes = draw(st.none() | st.just((*KINDS, "clock")))
    lain: list[tuple[str, int, float]] = []
    for number in range(draw(st.integers(0, 6))):
        name = f"o{number}"
        kind = draw(st.sampled_from(KINDS))
        other = draw(st.none() | st.sampled_from(KINDS))
        home.thing(
            name,
            kind,
            paint=draw(st.none() | st.sampled_from(sorted(PAINTS))),
            names=[("keys", draw(st.none() | st.just("anna")))] if draw(st.booleans()) else [],
            extent_m=draw(st.none() | st.just((0.3, 0.5)) | st.just((1.4, 0.8))),
            votes=[(kind, 7.0), (other, 3.0)] if other not in (None, kind) else [],
            tentative=draw(st.booleans()),
        )
        places = [draw(spots) for _ in range(2)]
        for _ in range(draw(st.integers(0, 5))):
            place, start = draw(st.integers(0, 1)), draw(minutes)
            home.seen(
                name,
                start,
                start + draw(st.sampled_from((0.0, 5.0, 30.0, 90.0))),
                at=places[place],
                place=place,
                probability=draw(st.sampled_from(PROBABILITIES)),
                times=draw(st.integers(1, 6)),
                box=draw(boxes()),
                absent=draw(st.none() | st.just(start + 100)),
            )
            lain.append((name, place, start))
    pairs = st.lists(st.tuples(*[st.sampled_from(lain)] * 2), max_size=4) if lain else st.just([])
    for one, other in draw(pairs):
        if one[0] != other[0]:
            shown = draw(boxes()), draw(boxes())
            home.met(one[0], other[0], one[2], boxes=shown, places=(one[1], other[1]))
    for number, room in enumerate(draw(st.lists(st.sampled_from(ROOMS), unique=True))):
        home.room(room, -2.0 + 4 * number, -1.0, 2.0 + 4 * number, 3.0)
    for minute in draw(st.lists(minutes, max_size=2)):
        home.look(minute, 0.0, 0.0)
    return home


@st.composite
def slices(draw: st.DrawFn) -> TimeSlice:
    """Draw a slice, open or closed, or a point in time."""
    low, high = sorted((draw(minutes), draw(minutes)))
    start = at(low) if draw(st.booleans()) else None
    return TimeSlice(start, at(high) if start is None or draw(st.booleans()) else None)


def plain_terms() -> st.SearchStrategy[ObjectTerm]:
    """Draw what else will do, or what a thing must not be."""
    looks = st.lists(st.sampled_from(("red", "big")), max_size=1).map(tuple)
    owner = st.none() | st.just("anna")
    return st.builds(ObjectTerm, st.sampled_from(WORDS), attributes=looks, owner=owner)


@st.composite
def terms(draw: st.DrawFn, var: str, *, deep: bool = True) -> ObjectTerm:
    """Draw what is asked for, with looks, an owner, a number or what it stands by."""
    word = draw(st.sampled_from(WORDS))
    colours = st.lists(st.sampled_from(("red", "dark blue", "big", "wooden")), max_size=2)
    where = None
    if deep and draw(st.integers(0, 4)) == 0:
        where = Where(draw(st.sampled_from(("near", "on"))), draw(terms("x", deep=False)))
    owner = draw(st.none() | st.sampled_from(("me", "anna")))
    quantity = draw(st.none() | st.integers(1, 3)) if draw(st.integers(0, 4)) == 0 else None
    denied = draw(st.sampled_from(("me", "anna"))) if draw(st.integers(0, 4)) == 0 else None
    several = 2 if draw(st.integers(0, 4)) == 0 else 0
    others = st.lists(plain_terms(), max_size=several).map(tuple)
    return ObjectTerm(
        {"mug": "cup"}.get(word, word),
        word,
        tuple(draw(colours)),
        tuple(draw(colours)) if draw(st.integers(0, 4)) == 0 else (),
        owner,
        quantity,
        where,
        var,
        "least" if quantity is None else draw(st.sampled_from(BOUNDS)),
        None if owner else denied,
        draw(others),
        draw(others),
    )


@st.composite
def queries(draw: st.DrawFn) -> FormalQuery:
    """Draw a formal query of any form: also such as no sentence would have."""
    relation = draw(st.none() | st.builds(Relation, st.sampled_from(RELATIONS), st.booleans()))
    number = 1 if relation is None else draw(st.integers(1, 3))  # cups together
    time = draw(st.none() | slices())
    place = draw(st.none() | st.sampled_from((*ROOMS, "attic")))
    ask = draw(st.sampled_from(ASKS))
    negated = draw(st.booleans()) if draw(st.integers(0, 3)) == 0 else False
    return FormalQuery(
        "drawn",
        "Q2" if relation else "Q3" if time else "Q1",
        ask,
        tuple(draw(terms(var)) for var in "xyz"[:number]),
        relation,
        place,
        time,
        draw(st.sampled_from(("last", "first", "all", "usual"))),
        negated,
        place is not None and draw(st.integers(0, 3)) == 0,
        (draw(st.sampled_from(ROOMS)),) if place and draw(st.integers(0, 3)) == 0 else (),
        negated and ask == "whether" and bool(relation or place) and draw(st.booleans()),
    )
