"""Rank moments by their probability of correctness (paper: "ordered by their probability").

The score begins as a product of what must all be true: the word means the object, the colour is
the asked one, the detector was right, the relation held. As these are not independent, the product
is then calibrated (`d3a.answering.calibration`). Every factor is kept and told in `why`.
"""

from __future__ import annotations

import heapq
import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from d3a.answering.calibration import calibrated, kind_of
from d3a.answering.distinct import Apart, things_of
from d3a.answering.moments import Entry, Moment
from d3a.answering.points import MINUTE
from d3a.model import Json
from d3a.parameters import DEFAULT
from grammar.forms import Select

TENTATIVE = 0.8
"""A thing seen too seldom to be confirmed may be a mistake that its own probability hides."""
UNJUDGED = 0.6
"""A condition that nobody could judge may well not hold."""
SUREST = 0.999
"""No detector is surer of one picture."""
LEAST_OF_BEST = 0.5
"""Time decides the order among those at least this likely against the best."""

VARIED = 0.8
"""Against the best: among those so likely what is new comes first, and no score falls by more."""
AS_LIKELY = 0.98
"""Against the best: nobody is told a difference of so few in a hundred."""


class Ranked(NamedTuple):
    """A moment with its score 0..1. A tuple: there are hundreds of them.

    unjudged: how many conditions of the question were left out. product: of the parts that must
    all be true; calibration: the factor from it to the probability of being right. repeat: the
    factor that takes a repeat to the score of what stands before it.
    """

    moment: Moment
    score: float
    unjudged: int = 0
    repeat: float = 1.0
    calibration: float = 1.0
    product: float = 1.0

    @property
    def why(self) -> tuple[Json, ...]:
        """Return the parts of the score, a record an entry; asked for what is shown alone."""
        extra: Json = {}
        if self.moment.relation is not None:
            extra["relation"] = round(self.moment.relation, 4)
        if self.moment.share is not None:
            extra["share"] = round(self.moment.share, 4)
        if self.unjudged:
            extra["unjudged"] = round(UNJUDGED**self.unjudged, 4)
        if self.calibration != 1.0:
            extra["calibration"] = round(self.calibration, 4)
        if self.repeat < 1.0:
            extra["repeat"] = round(self.repeat, 4)
        return tuple([entry_parts(entry) | extra for entry in self.moment.entries])


def rank(
    moments: Sequence[Moment],
    select: Select,
    *,
    spread: bool,
    unjudged: int = 0,
    at_ms: int | None = None,
    told: int | None = None,
    together_m: float = DEFAULT.together_m,
) -> list[Ranked]:
    """Return the moments best first.

    "all": by score. "last" and "first": by time among those at least half as likely as the best,
    each object at each place once before any twice; then the rest by score. "usual": by score,
    which holds the share of time. Ties go by start, then by object id and place.
    at_ms: a moment asked for: then time decides by the distance from it, before counts as nearer.
    unjudged: how many conditions of the question were left out. told: so many of them are told at
    most: of the others only what is new among them need not come first. together_m: what stands
    so near to another of its kind is in its picture as well, as a rule.
    """
    scored = _scored(moments, unjudged)
    scored.sort(key=_by_score)
    if at_ms is not None:
        return _by_time(scored, lambda moment: _distance(moment, at_ms))
    if select == "last":
        return _by_time(scored, lambda moment: (-moment.end_ms, 0))
    if select == "first":
        return _by_time(scored, lambda moment: (moment.start_ms, 0))
    if not spread:
        return scored
    return _spread(scored, len(scored) if told is None else told, together_m)


def views_probability(probability: float, views: int) -> float:
    """Return how likely a detection is right that was made `views` times with `probability`.

    Looks at one thing agree with each other, so n of them count as the square root of n.
    """
    return 1.0 - math.pow(1.0 - min(probability, SUREST), _looks(views))


def _looks(views: int) -> float:
    """Return as how many independent looks so many views count."""
    return math.sqrt(max(views, 1))


def entry_score(entry: Entry) -> tuple[float, Json]:
    """Return how likely one entry is what was asked, 0..1, and the parts of that."""
    return _of_stay(entry) * _detected(entry), entry_parts(entry)


def entry_parts(entry: Entry) -> Json:
    """Return the parts of how likely one entry is what was asked."""
    candidate, stay, sighting, place, held = entry
    asked = candidate.attributes
    why: Json = {
        "match": round(candidate.match, 4),
        "attributes": {word: round(p, 4) for word, p in asked.items()} if asked else {},
        "detection": round(sighting.probability, 4),
        "views": stay.seen if stay is not None else sighting.seen,
    }
    if is_tentative(entry):
        why["tentative"] = TENTATIVE
    if candidate.votes < 1.0:
        why["votes"] = round(candidate.votes, 4)  # it is in the match already
    if candidate.same < 1.0:
        why["same"] = round(candidate.same, 4)
    if place < 1.0:
        why["place"] = round(place, 4)
    if held < 1.0:
        why["where"] = round(held, 4)
    return why


def _of_stay(entry: Entry) -> float:
    """Return the part of the worth that all sightings of one object at one place share."""
    candidate = entry.candidate
    score = candidate.match
    if candidate.attributes:  # most are asked without, and the other factors are 1
        score *= math.prod(candidate.attributes.values())
    if is_tentative(entry):
        score *= TENTATIVE
    for factor in (candidate.same, entry.place, entry.held):
        if factor < 1.0:
            score *= factor
    return score


def _detected(entry: Entry) -> float:
    views = entry.stay.seen if entry.stay is not None else entry.sighting.seen
    return views_probability(entry.sighting.probability, views)


def is_tentative(entry: Entry) -> bool:
    """Whether the thing, or its being there, was seen too seldom to be confirmed."""
    return entry.candidate.record.tentative or (entry.stay is not None and entry.stay.tentative)


def _scored(moments: Sequence[Moment], unjudged: int) -> list[Ranked]:
    """Return the moments with their scores; what is one object's at one place is computed once."""
    shared: dict[tuple[int, int, float, float], tuple[float, float]] = {}
    left_out = UNJUDGED**unjudged
    out: list[Ranked] = []
    for moment in moments:
        product, by_looks = 1.0, False
        for entry in moment.entries:
            candidate, stay, sighting, place, held = entry
            key = (id(candidate), id(stay), place, held)
            own = shared.get(key)
            if own is None:
                own = shared[key] = (_of_stay(entry), 0.0 if stay is None else _looks(stay.seen))
            looks = own[1] or _looks(sighting.seen)
            missed = math.pow(1.0 - min(sighting.probability, SUREST), looks)
            product *= own[0] * (1.0 - missed)
            by_looks = by_looks or bool(candidate.attributes)
        if moment.relation is not None:
            product *= moment.relation
        right = calibrated(product, kind_of(len(moment.entries), by_looks=by_looks))
        score = right * left_out * (1.0 if moment.share is None else moment.share)
        factor = right / product if product > 0 else 1.0
        out.append(Ranked(moment, score, unjudged, 1.0, factor, product))
    return out


def _by_score(ranked: Ranked) -> tuple[float, int, str, int]:
    sighting = ranked.moment.figure.sighting
    return (-ranked.score, ranked.moment.start_ms, sighting.object_id, sighting.place)


def _ids(moment: Moment) -> tuple[str, ...]:
    return moment.ids


def _places(moment: Moment) -> tuple[tuple[str, int], ...]:
    return tuple([entry.sighting.stay for entry in moment.entries])  # quicker than lazily


def _spread(scored: Sequence[Ranked], told: int, together_m: float) -> list[Ranked]:
    """Return what shows something new before what repeats, among those about as likely.

    A repeat is not told as likelier than what stands before it, so that the list stays by score.
    What comes after so many as are told stays as it is.
    """
    if not scored:
        return []
    least = scored[0].score * VARIED
    likely = [one for one in scored if one.score >= least]
    out: list[Ranked] = []
    for group in (likely, scored[len(likely) :]):
        left = told - len(out)
        chosen = _new_first(group, left, together_m) if left > 0 else group
        for one in chosen:
            out.append(_at_most(one, out[-1].score) if out else one)
    return out


def _new_first(scored: Sequence[Ranked], told: int, together_m: float) -> list[Ranked]:
    """Return things not shown before first, then their other places, then the rest.

    What may be a thing shown already comes before their other places, and after what is surely
    another one: carried elsewhere under a new id, or beside one of its kind, which their places
    tell apart badly and whose picture shows it too, as a rule.

    Several things in a relation are new as a pair: first pictures that show pairs not shown
    before, each picture once; then every pair by a moment of its own; then its places.
    """
    waiting = list(scored)
    out: list[Ranked] = []
    keys: list[Callable[[Moment], object]] = [_ids, _places]
    if any(len(one.moment.entries) > 1 for one in waiting):
        out = _covering(waiting)
        chosen = {id(one) for one in out}
        waiting = [one for one in waiting if id(one) not in chosen]
    else:
        things = things_of(one.moment.figure.candidate.record for one in scored)
        keys.insert(0, lambda moment: things[moment.figure.candidate.record.object_id])
        out, waiting = _apart(waiting, things, together_m)
    for key_of in keys:
        if len(out) >= told:
            return out + waiting
        seen = {key_of(one.moment) for one in out}
        again: list[Ranked] = []
        for one in waiting:
            key = key_of(one.moment)
            (again if key in seen else out).append(one)
            seen.add(key)
        waiting = again
    rounds: dict[int, list[Ranked]] = {}
    times: Counter[tuple[tuple[str, int], ...]] = Counter()
    for one in waiting:
        key = _places(one.moment)
        rounds.setdefault(times[key], []).append(one)
        times[key] += 1
    return out + [one for number in sorted(rounds) for one in rounds[number]]


def _apart(
    scored: Sequence[Ranked], things: Mapping[str, int], together_m: float
) -> tuple[list[Ranked], list[Ranked]]:
    """Return what shows another thing away from those of its kind before it, and the rest.

    things: a number for each object, the same for those that may be one. Of what has no position
    nobody knows what it stands beside.
    """
    out: list[Ranked] = []
    rest: list[Ranked] = []
    seen: set[int] = set()
    kinds: dict[tuple[str, str], Apart] = {}
    for one in scored:
        figure = one.moment.figure
        record, stay = figure.candidate.record, figure.stay
        number, is_new = things[record.object_id], False
        if number not in seen:
            key = record.site, record.category
            if (apart := kinds.get(key)) is None:
                apart = kinds[key] = Apart(together_m)
            is_new = stay is None or stay.position is None or apart.add(stay.position)
        if is_new:
            seen.add(number)
        (out if is_new else rest).append(one)
    return out, rest


def _covering(scored: Sequence[Ranked]) -> list[Ranked]:
    """Return a moment of each picture that shows pairs of things that none before it shows.

    At each turn the one whose new pairs have the most score in sum, the first of them among
    those with a moment as likely as the best; of each its likeliest new pair. scored: best first.
    """
    pairs: dict[str, dict[tuple[str, ...], Ranked]] = {}
    for one in scored:
        frame = one.moment.figure.sighting.frame
        pairs.setdefault(frame, {}).setdefault(one.moment.ids, one)
    least = max(one.product for one in scored) * AS_LIKELY
    likeliest = {one.moment.figure.sighting.frame for one in scored if one.product >= least}
    out: list[Ranked] = []
    done: set[tuple[str, ...]] = set()

    def worth(frame: str) -> float:
        return -sum(one.score for key, one in pairs[frame].items() if key not in done)

    waiting = [(worth(frame), number, frame) for number, frame in enumerate(pairs)]
    first = min(turn for turn in waiting if turn[-1] in likeliest)
    waiting[waiting.index(first)] = (-math.inf, *first[1:])
    heapq.heapify(waiting)
    while waiting:
        _, number, frame = heapq.heappop(waiting)
        turn = (worth(frame), number, frame)
        new = [key for key in pairs[frame] if key not in done]
        if out and new and waiting and turn > waiting[0]:
            heapq.heappush(waiting, turn)  # what it showed was shown meanwhile
        elif new:
            out.append(pairs[frame][new[0]])
            done.update(new)
    return out


def _at_most(one: Ranked, ceiling: float) -> Ranked:
    if one.score <= ceiling:
        return one
    repeat = ceiling / one.score  # by position: there are hundreds of them
    return Ranked(one.moment, ceiling, one.unjudged, repeat, one.calibration, one.product)


def _distance(moment: Moment, at_ms: int) -> tuple[int, int]:
    """Return how far a moment is from another: 0 in its minute, then what came before it."""
    if moment.end_ms < at_ms:
        return (0, at_ms - moment.end_ms)
    return (
        (0, 0)
        if moment.start_ms < at_ms + round(MINUTE.total_seconds() * 1000)
        else (1, moment.start_ms - at_ms)
    )


def _by_time(scored: Sequence[Ranked], when: Callable[[Moment], tuple[int, int]]) -> list[Ranked]:
    if not scored:
        return []
    least = scored[0].product * LEAST_OF_BEST  # a newer look is told, though one look is no proof
    likely = [one for one in scored if one.product >= least]
    rest = [one for one in scored if one.product < least]

    def key_of(one: Ranked) -> tuple[int, int, float, str, int]:
        sighting = one.moment.figure.sighting
        return (*when(one.moment), -one.product, sighting.object_id, sighting.place)

    likely.sort(key=key_of)
    once: set[tuple[tuple[str, int], ...]] = set()
    fresh: list[Ranked] = []
    again: list[Ranked] = []
    for one in likely:
        key = _places(one.moment)
        (again if key in once else fresh).append(one)
        once.add(key)
    return fresh + again + rest
