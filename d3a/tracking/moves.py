"""Default profile: the identity of things that were moved.

A thing that turns up at a new place is an old one, or none that is known. Three things speak for
one that is known: the place that it left was looked at in vain since; the new place was looked at
in vain before; and they look alike. How alike different things look is learned from things that
cannot be one, as both were seen since. To inherit an id from whatever is most alike, as the paper
does, is right once in ten times.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from d3a.parameters import Parameters
from d3a.tracking.absence import GONE_MOST, SURE_SEEN, Absence
from d3a.tracking.alike import BINS, OTHER_PRIOR, assumed_others, bins_of, same_density
from d3a.tracking.arrivals import CAME_MOST
from d3a.tracking.kinds import Kind, Kinds
from d3a.tracking.known import Known
from d3a.tracking.likelihood import SAME, LookModel
from d3a.tracking.look_space import LookSpace, products
from d3a.tracking.memory import Memory
from d3a.tracking.rivals import Rivals
from d3a.tracking.sides import left_before

Floats = NDArray[np.float64]
LOOK_LEAST = -1.0
"""Log-odds of looks that speak against a move: below, places alone do not say what came."""
PLAIN_LOOK, LEFT_LEAST = 3.0, 2.5
"""A look whose log-odds tell a thing from all others of its category; and log-odds of its absence
from which a thing may be elsewhere, whatever it looks like. A link needs one of them."""
TAKEN_SIGMAS = 1.0
"""What is no farther from a thing, by what is known of both places, may be that thing."""
MORE_SEEN, MORE_GONE = 1.1, 0.25
"""A pair that was no plain move is asked again when what turned up was seen so many times as often,
or the place that was left has so much more evidence: in between little is known that could tell."""
ASK_AGAIN_MS = 1_800_000
"""And after so long: by then more is known of how alike things look, and of what else may be."""
ASKED_MOST = 1 << 16
"""Pairs of which that is remembered at most."""
Pair = tuple[Known, int]
"""What may be a move: what turned up, and where in `Kind.lasts` what left is."""
Came = Callable[[Known], float]
"""Log-odds that what turned up was brought while the robot was about."""


@dataclass(frozen=True, slots=True)
class Link:
    """`new` is `old`, moved; score: how likely that is, 0..1."""

    old: Known
    new: Known
    score: float


@dataclass(frozen=True, slots=True)
class Asked:
    """A category while its moves are looked for.

    likeness: how alike `kind.fresh` and `kind.lasts` look, (n, m), NaN where a look is unknown.
    brought: log-odds that a certain one of these came. looks: by number of a fresh one, the
    log-odds of its look against those of `kind.lasts`; arrivals: what is known of it; both as they
    are asked for. rivals: of all moves, one entry once it was asked for.
    """

    name: str
    kind: Kind
    likeness: Floats
    brought: float
    looks: dict[int, list[float]] = field(default_factory=dict)
    arrivals: dict[int, float] = field(default_factory=dict)
    rivals: list[Rivals] = field(default_factory=list)


class Moves:
    """Finds the moves that are plain, and learns how alike different things look."""

    def __init__(
        self,
        memory: Memory,
        space: LookSpace,
        looks: LookModel,
        absence: Absence,
        parameters: Parameters,
    ) -> None:
        self._memory = memory
        self._absence = absence
        self._space = space
        self._looks = looks
        self._parameters = parameters
        self._kinds = Kinds(memory, parameters.confirm_sightings)
        self.others: dict[str, list[float]] = {}
        """By category (BINS,): how often two different things of it were so much alike."""
        self.asked: dict[tuple[int, int], tuple[float, float, int]] = {}
        """By the numbers of the new and the old of pairs that were asked: from how many views of
        the new, from what evidence of absence of the old, and when they are asked again."""
        self.compared: set[int] = set()
        """Numbers of the things that `others` has learned from."""
        self._dense: dict[str, Floats] = {}
        """What `_densities` has told by category, until more is learned."""

    def find(self, changed: set[int], now_ms: int) -> list[Link]:
        """Return the moves that are likelier than all else that either thing may be, together.

        changed: numbers of the things that were seen, or missed, since the last call; a move has
        one of them at either end. By the numbers of the new and the old.
        """
        changed_of = self._by_category(changed)
        kinds = {name: self._kinds.of(name) for name in sorted(changed_of)}
        for kind in kinds.values():
            if not kind.is_compared:
                self._compare(kind)
        links: list[Link] = []
        for name, kind in kinds.items():
            if pairs := self._pairs(kind, changed_of[name], now_ms):
                # Any other of the category may have come, or one that is not known.
                brought = self._parameters.move_odds - math.log(len(kind.lasts) - 1)
                asked = Asked(name, kind, self._likenesses(kind), brought)
                self._look_at(asked, [new for new, _ in pairs])
                links += [link for pair in pairs if (link := self._link(asked, *pair)) is not None]
        return sorted(links, key=lambda link: (link.new.number, link.old.number))

    def _pairs(self, kind: Kind, changed: set[int], now_ms: int) -> list[Pair]:
        """Return what may be a move of a category, with one of its changed things at either end.

        Of those that were asked before only where more is known of either end since.
        """
        news = [new for new in kind.fresh if new.number in changed]
        pairs: list[Pair] = []
        for k, (old, place) in enumerate(kind.lasts):
            if not place.misses:
                continue
            last_ms, gone = place.last_ms, min(place.evidence, GONE_MOST)
            pairs += [
                (new, k)
                for new in (kind.fresh if old.number in changed else news)
                if last_ms < new.first_ms
                and new is not old
                and self._is_due(new, old, gone, now_ms)
            ]
        return pairs

    def _is_due(self, new: Known, old: Known, gone: float, now_ms: int) -> bool:
        """Say whether a pair is to be asked, as it is not known or more is known of it; note it."""
        key = new.number, old.number
        due = self.asked.get(key)
        if due is not None and new.seen < due[0] and gone < due[1] and now_ms < due[2]:
            return False
        if len(self.asked) >= ASKED_MOST:
            self.asked.clear()
        self.asked[key] = new.seen * MORE_SEEN, gone + MORE_GONE, now_ms + ASK_AGAIN_MS
        return True

    def asked_rows(self) -> Floats:
        """Return `asked` as rows (n, 5), in the order in which the pairs were asked first."""
        return np.array([(*key, *due) for key, due in self.asked.items()]).reshape(-1, 5)

    def restore_asked(self, rows: Floats) -> None:
        """Go on with what `asked_rows` gave."""
        self.asked = {
            (int(new), int(old)): (seen, gone, int(due_ms))
            for new, old, seen, gone, due_ms in rows.tolist()
        }

    def _by_category(self, changed: set[int]) -> dict[str, set[int]]:
        """Return the confirmed ones of the changed things by their categories."""
        least, things = self._parameters.confirm_sightings, self._memory.things
        found: dict[str, set[int]] = {}
        for number in changed:
            thing = things.get(number)
            if thing is not None and thing.seen >= least:
                found.setdefault(thing.category, set()).add(number)
        return found

    def _link(self, asked: Asked, new: Known, k: int) -> Link | None:
        """Return the move to a fresh thing from the last place of `lasts[k]`, if it is plain.

        Against all that either end may be instead. What may be known of arrivals is dear, and
        nearly no move is plain at its best, so the best that it can be is asked for first.
        """
        least, look = self._parameters.move_probability, asked.looks[new.number][k]
        if look < LOOK_LEAST or self._odds(asked, new, k, _surely_brought) * (1.0 - least) < least:
            return None
        old, place = asked.kind.lasts[k]
        left = place.evidence >= LEFT_LEAST and old.seen >= SURE_SEEN
        if not left and look < PLAIN_LOOK:
            return None
        # alone, before all others are asked for
        if self._odds(asked, new, k, self._came(asked)) * (1.0 - least) < least:
            return None
        chance = self._chance(asked, new, k)
        return Link(old, new, chance) if chance >= least and not self._is_taken(new) else None

    def _came(self, asked: Asked) -> Came:
        """Return what tells the log-odds of arrivals, each asked for once."""

        def came(thing: Known) -> float:
            if thing.number not in asked.arrivals:
                asked.arrivals[thing.number] = self._absence.came(thing.head)
            return asked.arrivals[thing.number]

        return came

    def _is_taken(self, new: Known) -> bool:
        """Say whether what turned up is most likely a view of what stands there.

        Something better known was there before and was seen there since, and never in one frame
        with it: a thing that is named wrongly now and then.
        """
        positions, row = self._memory.positions, new.head.row
        if row < 0:
            return False
        away = positions.spots[1:] - positions.spots[1:, row, None]
        away *= away
        away /= positions.variance + positions.variance[:, row, None]
        near = np.add.reduce(away, axis=0) <= TAKEN_SIGMAS**2
        there = (positions.owners[each] for each in near.nonzero()[0].tolist())
        return any(
            place.first_ms < new.first_ms <= place.last_ms
            and thing.seen > new.seen
            and thing.number not in new.met
            for thing, place in there
        )

    def _chance(self, asked: Asked, new: Known, k: int) -> float:
        """Return how likely a pair is a move, and no rival is.

        Its rivals are moves of another thing to the same place, and of the thing to another; each
        counts by how likely neither end of it is better explained (see `rivals`). So the traces
        that one thing left where it was before do not speak against each other.
        """
        kind = asked.kind
        if not asked.rivals:
            asked.rivals.append(Rivals.of(self._all_odds(asked)))
        rivals, row = asked.rivals[0], kind.fresh.index(new)
        counts = np.array([
            self._may_be_gone(asked, new, k, j) if odds > 0.0 else 1.0
            for j, odds in enumerate(rivals.odds[row].tolist())
        ])  # fmt: skip
        return rivals.chance(row, k, counts)

    def _all_odds(self, asked: Asked) -> Floats:
        """Return the odds of all moves of a category, as `_odds`, 0 where times speak against it.

        (fresh, lasts). What nobody looked for may have left too.
        """
        kind = asked.kind
        self._look_at(asked, kind.fresh)
        came, odds = self._came(asked), np.zeros((len(kind.fresh), len(kind.lasts)))
        for row, new in zip(odds, kind.fresh, strict=True):
            looks = asked.looks[new.number]
            for k, (old, place) in enumerate(kind.lasts):
                if looks[k] >= LOOK_LEAST and place.last_ms < new.first_ms and old is not new:
                    row[k] = self._odds(asked, new, k, came)
        return odds

    def _may_be_gone(self, asked: Asked, new: Known, k: int, j: int) -> float:
        """Return how much more that of `lasts[j]` counts as what came, against that of `lasts[k]`.

        It may have left where nobody looked, and looks in vain that are more than it takes to be
        sure that a thing left say nothing of which of those that left came: what counts are
        chances, which end at 1.
        """
        lasts = asked.kind.lasts
        own, other = (left_before(*lasts[each], new.first_ms) for each in (k, j))
        gone, lost = (min(lasts[each][1].evidence, GONE_MOST) for each in (k, j))
        return math.exp(max(0.0, gone + own) - own - max(0.0, lost + other) + other)

    def _odds(self, asked: Asked, new: Known, k: int, came: Came) -> float:
        """Return the odds that a fresh thing is that of `lasts[k]`, moved; it rises with `came`."""
        look = asked.looks[new.number][k]
        if look < LOOK_LEAST:
            return 0.0
        odds, prior = look + min(asked.kind.lasts[k][1].evidence, GONE_MOST), asked.brought
        if odds + prior > -CAME_MOST:  # else it is neither a link, nor much of a rival to one
            prior += came(new)
        if look >= PLAIN_LOOK:
            prior = max(prior, self._parameters.alike_odds)
        return math.exp(min(odds + prior, 50.0))

    def _look_at(self, asked: Asked, fresh: list[Known]) -> None:
        """Learn what the looks of some fresh things say, of those that were not asked for yet."""
        wanted = {new.number for new in fresh if new.number not in asked.looks}
        if not wanted:
            return
        rows = [row for row, new in enumerate(asked.kind.fresh) if new.number in wanted]
        likeness = asked.likeness[rows]
        # Means vary less than the views that are compared with them.
        usual = math.sqrt(max(self._looks.mean(SAME), 0.0))
        dense = self._densities(asked.name)[bins_of(np.nan_to_num(likeness))]
        told = np.nan_to_num(np.log(same_density(likeness - usual) / dense), nan=-math.inf)
        for row, looks in zip(rows, told.tolist(), strict=True):
            asked.looks[asked.kind.fresh[row].number] = looks

    def _likenesses(self, kind: Kind) -> Floats:
        """Return how alike fresh things look and all of their category, see `Asked`."""
        things = [thing for thing, _ in kind.lasts]
        if self._memory.looks.length == 0:
            return np.full((len(kind.fresh), len(things)), math.nan)
        units = self._memory.looks.units(things, self._space)
        row = {thing.number: k for k, thing in enumerate(things)}
        at = [row[new.number] for new in kind.fresh]
        likeness = products(units[at], units)
        if not all(weights := [thing.look_weight for thing in things]):
            known = np.array(weights) > 0
            likeness[~(known[at][:, None] & known)] = math.nan
        return likeness

    def _likeness(self, one: Known, others: list[Known]) -> Floats:
        """Return the cosines of a thing with those of some others whose looks are known."""
        known = [other for other in others if other.look_weight > 0]
        if one.look_weight == 0 or not known:
            return np.empty(0)
        looks = self._memory.looks
        return np.asarray(looks.units(known, self._space) @ looks.unit(one, self._space))

    def _compare(self, kind: Kind) -> None:
        """Learn from those that were seen elsewhere since: they are other things."""
        kind.is_compared = True
        for new in kind.fresh:
            if new.number in self.compared:
                continue
            self.compared.add(new.number)
            others = [o for o, _ in kind.lasts if o.last_ms >= new.first_ms and o is not new]
            if others:
                self._dense.clear()
                counts = self.others.setdefault(new.category, [0.0] * BINS)
                for k in bins_of(self._likeness(new, others)).tolist():
                    counts[k] += 1.0

    def _densities(self, kind: str) -> Floats:
        """Return how dense different things of a category lie at likenesses (BINS,).

        From there up, smoothed. Chairs of a set look alike, and say little of the cups: what is
        usual is told by all categories, each by `OTHER_PRIOR` pairs at most, and is worth as many
        against the category's own.
        """
        if (known := self._dense.get(kind)) is not None:
            return known
        usual = assumed_others()
        for category in sorted(self.others):
            counts = np.array(self.others[category])
            usual += counts * min(1.0, OTHER_PRIOR / max(float(counts.sum()), 1.0))
        pairs = usual * (OTHER_PRIOR / usual.sum()) + np.array(self.others.get(kind, 0.0))
        above = pairs[::-1].cumsum()[::-1]
        first = np.maximum(np.arange(BINS) - 1, 0)
        density = np.asarray(above[first] / above[0] / ((BINS - first) * 2 / BINS))
        self._dense[kind] = density
        return density


def _surely_brought(_: Known) -> float:
    return CAME_MOST
