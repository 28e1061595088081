"""Carry out what a person teaches in a conversation, and confirm it in a sentence.

It goes through `d3a.teaching`: kept in the store at once, used by the next question, undone by
"undo". What cannot be done is a sentence too, with what would do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime

from assistant.english import article, counted, sentence_case
from assistant.own_words import said_back
from assistant.phrases import kind_of
from assistant.pointing import NOTHING_SHOWN, find_row, same_place
from assistant.recalling import recalled, row_name, undone_words
from assistant.taught import (
    Boxing,
    Difference,
    Naming,
    PlaceNaming,
    PlaceRenaming,
    Recalling,
    Row,
    Sameness,
    Teaching,
    Undoing,
)
from assistant.told import said_name
from d3a import teaching as store_teaching
from d3a.answer import RankedKeyframe, is_by_look
from d3a.correcting.taught_looks import teach_look
from d3a.model import BadInput, Box
from d3a.store.base import Store
from grammar import vocabulary
from grammar.nountags import KIN
from grammar.vocabulary import lexicon

ROOM_M, SPOT_M = 2.0, 1.0
"""How far around a point a place reaches that was named with one word: a room, or a spot."""
SAME_BOX = 0.5
"""Two boxes that share more than this are of one thing."""
BACK = "“undo” takes it back"


@dataclass(frozen=True, slots=True)
class Learned:
    """What came of a teaching. done: the store has it. choices: what may be said instead.

    refused: the row that is not what was meant, so that the next best is wanted.
    """

    sentence: str
    done: bool = True
    choices: tuple[str, ...] = ()
    refused: RankedKeyframe | None = None


@dataclass(frozen=True, slots=True)
class Scene:
    """What stands on the screen: the rows of the last answer, and the one pointed at.

    box: what the person drew on its picture, in pixels of the frame; None for none.
    """

    rows: tuple[RankedKeyframe, ...] = ()
    pointed: RankedKeyframe | None = None
    box: Box | None = None

    def row(self, number: Row) -> RankedKeyframe | None:
        """Return the row of a number, the one pointed at for None."""
        return self.pointed if number is None else find_row(self.rows, number)

    @property
    def things(self) -> tuple[RankedKeyframe, ...]:
        """The first row of each thing."""
        first = {row.object_id: row for row in reversed(self.rows)}
        return tuple(sorted(first.values(), key=lambda row: row.rank))


def learn(store: Store, said: Teaching, scene: Scene, now: datetime) -> Learned | None:
    """Do what was said; None where it says no more than "not this one".

    Raises StoreError; whatever else cannot be done is a sentence.
    """
    try:
        match said:
            case Boxing():
                return _box(store, said, scene)
            case Naming(row=None, isnt=False) if scene.box is not None:
                return _name_in_box(store, said, scene, scene.box, now)
            case Naming():
                return _name(store, said, scene, now)
            case PlaceNaming():
                return _name_place(store, said, scene, now)
            case PlaceRenaming():
                return _rename_place(store, said, now)
            case Sameness():
                return _same(store, said, scene, now)
            case Difference():
                return _different(store, said, scene, now)
            case Undoing():
                return Learned(undone_words(store_teaching.undo(store)))
            case Recalling():
                return Learned(recalled(store, now))
    except BadInput as error:
        return Learned(f"I cannot do that: {error}", done=False)


def _name(store: Store, said: Naming, scene: Scene, now: datetime) -> Learned | None:
    row = scene.row(said.row)
    if row is None:
        return _no_row(said.row, scene)
    (word, owner), thing = said_name(said.said, kind_of(row), now), row_name(row)
    heard = said_back(said.heard, kind_of(row))
    if said.isnt:
        known = store.objects(ids=[row.object_id], embeddings=False)
        if not any(n.word == word and owner in (None, n.owner) for r in known for n in r.names):
            return _deny(store, said, row, (word, owner), now)
        store_teaching.forget_name(
            store, row.object_id, word, owner, at_ms=_ms(now), heard=said.heard
        )
        return Learned(f"I no longer take {thing} for “{heard}”; {BACK}.")
    doubt = "" if said.sure else _doubt(said.said, word, owner, row, store)
    if doubt:
        ask_ = f"{doubt} Shall I remember it as “{heard}” all the same?"
        which = "it" if said.row is None else f"number {row.rank}"
        sure = f"Call {which} {said.heard} all the same"
        return Learned(ask_, done=False, choices=(sure,))
    done = store_teaching.teach_name(
        store, row.object_id, word, owner, at_ms=_ms(now), heard=said.heard
    )
    if done.number == 0:
        return Learned(f"I know {thing} as “{heard}” already.")
    return Learned(f"I will remember {thing} as “{heard}”; {BACK}.")


def _deny(
    store: Store, said: Naming, row: RankedKeyframe, name: tuple[str, str | None], now: datetime
) -> Learned | None:
    """Remember whose a thing is not; None for a mere word, which may be said of this row alone."""
    word, owner = name
    if owner is None:
        return None
    done = store_teaching.deny_name(
        store, row.object_id, word, owner, at_ms=_ms(now), heard=said.heard
    )
    heard = f"{row_name(row)} for “{said_back(said.heard, kind_of(row))}”"
    if done.number == 0:
        return Learned(f"I do not take {heard} already.", refused=row)
    return Learned(f"I will not take {heard} any more; {BACK}.", refused=row)


def _doubt(said: str, word: str, owner: str | None, row: RankedKeyframe, store: Store) -> str:
    """Return why a name is hardly meant for this thing; "" where it may well be."""
    if owner is None and _is_somebody(word.lower(), store):
        return f"{sentence_case(word)} is somebody whose things may be asked for."
    if _looks_otherwise(said, word, row, store):
        return f"That looks like {article(kind_of(row))}."
    return ""


def _is_somebody(word: str, store: Store) -> bool:
    """Whether a word is kin, or a person whose things were taught; any other name may be given."""
    return word in KIN or any(name.owner == word for name in store.names())


def _looks_otherwise(said: str, word: str, row: RankedKeyframe, store: Store) -> bool:
    """Whether somebody's thing is of quite another kind than what the detector takes it for.

    "That is a vase" corrects the detector; "my keys" may be said of the wrong row. A word that
    the vocabulary has not may be anything's name.
    """
    noun = lexicon().known_noun(word) or lexicon().known_noun(word.rpartition(" ")[2])
    if noun is None or said.startswith(("a ", "an ", "the ")):
        return False
    [thing] = store.objects(ids=[row.object_id], votes=True, embeddings=False)
    kinds = {vocabulary.canonical(name) for name in (row.category, *dict(thing.categories))}
    meant = vocabulary.canonical(noun)
    wider = {meant, *vocabulary.broader(meant)}
    return not any(wider & {kind, *vocabulary.broader(kind)} for kind in kinds)


def _box(store: Store, said: Boxing, scene: Scene) -> Learned:
    """Say whether a box can be meant; the conversation keeps it."""
    row = scene.pointed
    picture = store.keyframe(row.image) if row is not None and row.image else None
    if picture is None:
        return Learned("There is no picture to draw on: ask for something near it.", done=False)
    x1, y1, x2, y2 = said.box
    if not (0 <= x1 < x2 <= picture.width and 0 <= y1 < y2 <= picture.height):
        size = f"{picture.width} x {picture.height} pixels"
        return Learned(f"The box is not in the picture, which has {size}.", done=False)
    return Learned("I see the box. Say what is in it: these are my keys.")


def _name_in_box(
    store: Store, said: Naming, scene: Scene, box: Box, now: datetime
) -> Learned | None:
    """Name what is in a box: the thing that the detector saw there, else a look of its own."""
    row = scene.pointed
    if row is None or row.image is None:
        return _no_row(None, scene)
    known = _seen_in(store, row, box)
    if known is not None:
        return _name(store, said, replace(scene, pointed=known), now)
    word, owner = said_name(said.said, "", now)
    if not word:
        return Learned("Say what it is, too: these are my keys.", done=False)
    done = teach_look(store, row.image, box, word, owner, at_ms=_ms(now), heard=said.heard)
    others = done.arguments["found"] - 1
    where = counted(others, "other picture") if others else "no other picture"
    has = "has" if others < 2 else "have"
    name = said_back(said.heard, kind_of(row))
    return Learned(
        f"I will know “{name}” by the colours in the box; {where} {has} what looks like it; {BACK}."
    )


def _seen_in(store: Store, row: RankedKeyframe, box: Box) -> RankedKeyframe | None:
    """Return the row as that of the thing that the detector has a box for where one was drawn."""
    picture = store.keyframe(row.image) if row.image else None
    at = picture.time_ms if picture is not None else _ms(row.end)
    seen = [s for s in store.sightings(start_ms=at, end_ms=at) if s.image == row.image]
    best = max(seen, key=lambda s: overlap(s.box, box), default=None)
    if best is None or overlap(best.box, box) < SAME_BOX:
        return None
    if best.object_id == row.object_id:
        return row
    [thing] = store.objects(ids=[best.object_id], embeddings=False)
    return replace(row, object_id=best.object_id, category=thing.category)


def overlap(a: Box, b: Box) -> float:
    """Return the share of two boxes that both have: intersection over union."""
    width = min(a[2], b[2]) - max(a[0], b[0])
    height = min(a[3], b[3]) - max(a[1], b[1])
    if width <= 0 or height <= 0:
        return 0.0
    both = width * height
    return both / ((a[2] - a[0]) * (a[3] - a[1]) + (b[2] - b[0]) * (b[3] - b[1]) - both)


def _name_place(store: Store, said: PlaceNaming, scene: Scene, now: datetime) -> Learned:
    radius = ROOM_M if said.name in lexicon().places else SPOT_M
    around, where = None, "where I stand"
    if scene.pointed is not None and not said.here:
        if scene.pointed.position is None:
            return Learned("I do not know where that is, so I cannot name the place.", done=False)
        around = scene.pointed.position[:2]
        where = row_name(scene.pointed)
    taken = [r.name for r in store.regions() if r.name.casefold() == said.name.casefold()]
    if taken and not said.anew:
        ways = (f"Call this place anew the {taken[0]}", f"Where is the {taken[0]}?")
        already = f"There is a place called {taken[0]} already. Shall I draw it anew here?"
        return Learned(already, done=False, choices=ways[:1])
    store_teaching.name_place(
        store, said.name, around=around, radius_m=radius, replace=said.anew, at_ms=_ms(now)
    )
    return Learned(f"I will call the place {radius:g} m around {where} “{said.name}”; {BACK}.")


def _rename_place(store: Store, said: PlaceRenaming, now: datetime) -> Learned:
    if said.new is None:
        store_teaching.remove_place(store, said.name, at_ms=_ms(now))
        return Learned(f"“{said.name}” is no place any more; {BACK}.")
    store_teaching.rename_place(store, said.name, said.new, at_ms=_ms(now))
    return Learned(f"I will call “{said.name}” “{said.new}”; {BACK}.")


def _same(store: Store, said: Sameness, scene: Scene, now: datetime) -> Learned:
    one = scene.row(said.row)
    if one is None:
        return _no_row(said.row, scene)
    if said.other is None:
        others = [row for row in scene.things if row.object_id != one.object_id]
        if len(others) != 1:
            return _which_other(one, others)
        other: RankedKeyframe | None = others[0]
    else:
        other = scene.row(said.other)
    if other is None:
        return _no_row(said.other, scene)
    if one.object_id == other.object_id:
        return Learned(f"I take {_pair(one, other)} for one {kind_of(one)} already.")
    # the id of what a detector knows is kept: later recordings see it again
    kept, gone = sorted((one, other), key=lambda row: (is_by_look(row.object_id), row.rank))
    try:
        store_teaching.merge(store, kept.object_id, gone.object_id, force=said.sure, at_ms=_ms(now))
    except BadInput as error:
        if said.sure:
            raise
        sure = f"Number {kept.rank} and number {gone.rank} are the same even so"
        if "shows both" not in str(error):
            raise
        both = "One picture shows both, so I take them for two."
        return Learned(both, done=False, choices=(sure,))
    return Learned(f"I will take {_pair(one, other)} for one {kind_of(kept)}; {BACK}.")


def _which_other(one: RankedKeyframe, others: Sequence[RankedKeyframe]) -> Learned:
    if not others:
        return Learned("There is no other thing in the list that it could be.", done=False)
    numbers = [f"Number {one.rank} is the same as number {row.rank}" for row in others[:3]]
    return Learned("The same as which?", done=False, choices=tuple(numbers))


def _different(store: Store, said: Difference, scene: Scene, now: datetime) -> Learned:
    one = scene.row(said.row)
    if one is None:
        return _no_row(said.row, scene)
    other = scene.row(said.other) if said.other is not None else None
    if said.other is not None and other is None:
        return _no_row(said.other, scene)
    if other is not None:
        if other.object_id != one.object_id:
            return Learned(f"I take {_pair(one, other)} for two things already.")
        if same_place(one, other):
            words = "Both are looks at one place, where I cannot tell two things apart."
            return Learned(words, done=False)
        one = max(one, other, key=lambda row: row.rank)
    place = stay_of(store, one)
    if place is None:
        return Learned("I no longer find that sighting in my memory.", done=False)
    stays = store.stays(object_ids=[one.object_id])
    if len(stays) == 1:
        words = f"I saw {row_name(one)} at this place only, as a thing of its own already."
        return Learned(words, done=False)
    store_teaching.split(store, one.object_id, place, at_ms=_ms(now))
    return Learned(
        f"I will take {row_name(one)} for another thing than what I saw elsewhere; {BACK}."
    )


def stay_of(store: Store, row: RankedKeyframe) -> int | None:
    """Return the place number of the stay whose sighting a row shows, None where it is gone."""
    seen = store.sightings(object_ids=[row.object_id], start_ms=_ms(row.start), end_ms=_ms(row.end))
    exact = [each for each in seen if each.frame == row.frame and each.box == row.box]
    return next((each.place for each in (*exact, *seen)), None)


def _pair(*rows: RankedKeyframe) -> str:
    one, other = sorted(rows, key=lambda row: row.rank)
    return f"number {one.rank} and number {other.rank}"


def _no_row(row: Row, scene: Scene) -> Learned:
    if not scene.rows:
        return Learned(NOTHING_SHOWN, done=False)
    return Learned(f"There is no number {row}; the list has {len(scene.rows)}.", done=False)


def _ms(moment: datetime) -> int:
    return round(moment.timestamp() * 1000)
