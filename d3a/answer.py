"""The answer to a question, as the contract `answer` of the JSON output has it."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import datetime
from typing import Any, Literal

from d3a.model import Box, Json, Position
from grammar.forms import FormalQuery

SCHEMA = 1
Status = Literal[
    "found", "not_found", "unknown_object", "not_understood", "out_of_scope", "ambiguous", "error"
]
BY_LOOK = "look-"
"""How the id of an object begins that a person taught by a box (`taught_looks`)."""
Reason = Literal["never", "not_then", "not_there", "gone", "not_recognisable", "empty"]


def is_by_look(object_id: str) -> bool:
    """Whether an object is known by its look alone, so that an answer must say so."""
    return object_id.startswith(BY_LOOK)


@dataclass(frozen=True, slots=True)
class RankedKeyframe:
    """One keyframe of an answer, best first (paper: "ordered by their probability of correctness").

    score: how likely it shows what was asked, 0..1; why: the parts of the score.
    frame: the recording's name; image: the key of the stored picture. box: pixels of that frame.
    start, end: the sighting's closed interval, in the home's zone. group: the moment of a relation.
    beyond: the nearest landmark and its distance in metres where none is `near`, for the sentence;
    not part of the record. vague: a landmark as far off as the position is uncertain, where that
    is too uncertain to be told as `near`; for the sentence too. within: the part of the interval
    in the asked slice, where that is not all of it: nobody is told of a time not asked about.
    first_missed: when a later round first looked at its place and did not see it, before the look
    that told that it was gone (`last_absent`); known of what is told in words, and in the record
    where it is known.
    """

    rank: int
    score: float
    object_id: str
    category: str
    frame: str
    probability: float
    box: Box | None
    start: datetime
    end: datetime
    position: Position | None = None
    place: str | None = None
    near: str | None = None
    seen: int = 1
    last_absent: datetime | None = None
    image: str | None = None
    why: Json = field(default_factory=dict)
    group: int | None = None
    beyond: tuple[str, float] | None = None
    vague: str | None = None
    within: tuple[datetime, datetime] | None = None
    first_missed: datetime | None = None

    @property
    def first(self) -> datetime:
        """Return when it was seen first in the interval, as far as that was asked about."""
        return self.within[0] if self.within is not None else self.start

    @property
    def last(self) -> datetime:
        """Return when it was seen last in the interval, as far as that was asked about."""
        return self.within[1] if self.within is not None else self.end

    def to_json(self) -> Json:
        """Return the keyframe's record, every field present."""
        missed = {"first_missed": self.first_missed.isoformat()} if self.first_missed else {}
        return missed | {
            "rank": self.rank,
            "score": round(self.score, 4),
            "object_id": self.object_id,
            "category": self.category,
            "frame": self.frame,
            "probability": round(self.probability, 4),
            "box": [round(v, 1) for v in self.box] if self.box else None,
            "position": [round(v, 3) for v in self.position] if self.position else None,
            "place": self.place,
            "near": self.near,
            "start": self.start.isoformat(),
            "end": self.end.isoformat(),
            "seen": self.seen,
            "last_absent": self.last_absent.isoformat() if self.last_absent else None,
            "image": self.image,
            "why": self.why,
            "group": self.group,
        }


@dataclass(frozen=True, slots=True)
class Answer:
    """What is printed, batched and shown: a sentence, ranked keyframes, and what led to them.

    status: whether any sighting is what was described, and not the yes or no that is told: "is
    there no tv here" is not_found where that is right, as "is there a tv here" is then.
    count: distinct objects that match, before the limit. value: the number asked for (objects,
    seconds, sightings). otherwise: the nearest true keyframe outside of the asked slice or place.
    perhaps: for a no that is not sure, what may be it after all, the likeliest first; then
    `otherwise` is the first of them.
    unjudged: conditions this store cannot judge. looked_then: for a no about a time, or what was
    seen before and after a moment, whether there was any look then (into the asked room), and
    False of a room that was never looked into; for the sentence, not part of the record.
    count of a no: how many there were where more were asked for.
    amounts: of several objects that were counted at once, the least and the most of each. kinds:
    of what is listed, how many must be different things of each category.
    stayed: from when to when it was so whenever it was seen, by time, where how long is asked;
    in_view: for how many seconds of that it was seen. doubted: the categories of what was there
    and may be elsewhere by now, so that it is not listed; for the sentence, as the next four.
    least: how many of `count` must be different things: a moved one may have got a new id.
    apart: for a no about moving, at how many places things were seen then that may be one.
    denied: of how many things people said that they are not the owner's who is asked about, so
    that they were left out; precision: the rung of the matching ladder that was forced.
    alike: how many objects the first noun and its looks mean, wherever and whenever they were seen.
    colours: of things of one kind that are listed, by id, the colour that each looked.
    named_alone: the things that a name alone chose for the first object, as people taught it.
    elapsed_ms: parse, retrieve, rank, total.
    """

    text: str = ""
    status: Status = "found"
    answer: str = ""
    reason: Reason | None = None
    query: FormalQuery | None = None
    count: int = 0
    value: float | None = None
    keyframes: tuple[RankedKeyframe, ...] = ()
    otherwise: RankedKeyframe | None = None
    perhaps: tuple[RankedKeyframe, ...] = ()
    unjudged: tuple[str, ...] = ()
    suggestions: tuple[str, ...] = ()
    last_looked: datetime | None = None
    looked_then: bool | None = None
    least: int = 0
    apart: int = 0
    amounts: tuple[tuple[int, int], ...] = ()
    kinds: tuple[tuple[str, int], ...] = ()
    stayed: tuple[tuple[datetime, datetime], ...] = ()
    in_view: float = 0.0
    doubted: tuple[str, ...] = ()
    denied: int = 0
    alike: int = 0
    colours: tuple[tuple[str, str], ...] = ()
    named_alone: tuple[str, ...] = ()
    precision: str | None = None
    truncated: bool = False
    elapsed_ms: dict[str, float] = field(default_factory=dict)
    id: str | None = None
    message: str | None = None
    position: int | None = None

    @property
    def instead(self) -> tuple[RankedKeyframe, ...]:
        """What is shown of a no: what may be it, else what is true elsewhere; else nothing."""
        return self.perhaps or ((self.otherwise,) if self.otherwise else ())

    def to_json(self) -> Json:
        """Return the answer's record; `message` and `position` only where there is an error.

        `perhaps` only where a no is not sure.
        """
        record: dict[str, Any] = {
            "schema": SCHEMA,
            "id": self.id,
            "text": self.text,
            "status": self.status,
            "reason": self.reason,
            "answer": self.answer,
            "query": self.query.to_json() if self.query else None,
            "count": self.count,
            "value": self.value,
            "keyframes": [keyframe.to_json() for keyframe in self.keyframes],
            "otherwise": self.otherwise.to_json() if self.otherwise else None,
            "unjudged": list(self.unjudged),
            "suggestions": list(self.suggestions),
            "last_looked": self.last_looked.isoformat() if self.last_looked else None,
            "truncated": self.truncated,
            "elapsed_ms": {name: round(ms, 3) for name, ms in self.elapsed_ms.items()},
        }
        if self.perhaps:
            record["perhaps"] = [keyframe.to_json() for keyframe in self.perhaps]
        if self.message is not None:
            record["message"] = self.message
        if self.position is not None:
            record["position"] = self.position
        return record
