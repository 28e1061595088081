"""Attributes of the question scored against the objects found: colours, sizes, or nothing.

Nothing about attributes is stored (DESIGN, decision 5). Colours come from the histogram, sizes
from depth relative to the objects of the same word. What neither can tell is left unjudged.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from d3a.answering.match import Candidate, Lexicon
from d3a.answering.pairs import normal_cdf
from d3a.colours import (
    BASIC,
    LEAST_ODDS,
    Appearances,
    Palette,
    carries_histogram,
    histograms,
    is_colour,
    words_of,
)
from d3a.frozen import maker
from d3a.plan import JudgeAttributes
from d3a.store.base import ObjectRecord

_candidate = maker(Candidate)
UNKNOWN = 0.5
"""The chance of an attribute for an object without a picture, where others have one."""
SIZE_SPREAD = 0.25
"""Deviation of the logarithm of a measured size: depth and boxes are rough."""
NOTICED = 0.18
"""How much the logarithm of a size must be off the usual to be noticed: a fifth larger is big."""
LIKELIER = 0.5
"""What is no likelier to be noticed as big than not is not big: sizes have no shades between."""
LEAST_ONCE = 0.7
"""Of a thing seen once, which may be a mistake of the detector, a yes needs to be this likely."""
LEAST_DOUBTFUL = 0.05
"""What is less likely than this is not even listed below what is likely, and a no is flat."""
LEAST_SIZED = 2
"""Sizes are relative: with fewer measured things of the kind, nothing is big or small."""
_SIZES: dict[str, tuple[str, float]] = {
    **dict.fromkeys(("big", "large", "huge", "giant", "massive", "enormous"), ("area", 1.0)),
    **dict.fromkeys(("bigger", "biggest", "larger", "largest", "oversized"), ("area", 1.0)),
    **dict.fromkeys(("large-sized",), ("area", 1.0)),
    **dict.fromkeys(("small", "little", "tiny", "mini", "compact"), ("area", -1.0)),
    **dict.fromkeys(("smaller", "smallest", "small-sized"), ("area", -1.0)),
    **dict.fromkeys(("tall", "taller", "tallest", "high"), ("height", 1.0)),
    **dict.fromkeys(("short", "shorter", "shortest", "low"), ("height", -1.0)),
    **dict.fromkeys(("wide", "broad"), ("width", 1.0)),
    **dict.fromkeys(("narrow", "slim", "thin"), ("width", -1.0)),
}
_COMPARED = frozenset(word for word in _SIZES if word.endswith(("est", "er")))
"""What is the biggest, or bigger with nothing said that it is bigger than, is so among all."""


@dataclass(frozen=True, slots=True)
class Looks:
    """The colours of some objects, read once for every colour word that is asked of them.

    rows (m,): which of the objects have a histogram; of_rows: how these look.
    """

    rows: NDArray[np.intp]
    of_rows: Appearances

    @classmethod
    def of(cls, records: Sequence[ObjectRecord], palette: Callable[[], Palette]) -> Looks | None:
        """Read the histograms of objects, None where there are none.

        palette: read only where there are, it costs a query.
        """
        carried = [
            (row, record.embedding)
            for row, record in enumerate(records)
            if record.embedding is not None
            and carries_histogram(record.embedding_model, len(record.embedding))
        ]
        if not carried:
            return None
        matrix = histograms(np.stack([embedding for _, embedding in carried]))
        held = matrix.any(axis=1)
        if not held.any():
            return None
        rows = np.array([row for row, _ in carried], dtype=np.intp)[held]
        views = np.array([records[row].weight for row in rows.tolist()], dtype=np.float64)
        return cls(rows, Appearances.of(matrix[held], palette(), views))


def seen_colours(looks: Looks | None) -> dict[int, tuple[str, ...]]:
    """Return the basic colours that objects rather looked than not, by row, the likeliest first.

    What has no histogram, and what looked like none likely enough, is left out.
    """
    if looks is None:
        return {}
    told: dict[int, tuple[str, ...]] = {}
    for row, chances in zip(looks.rows.tolist(), looks.of_rows.chances, strict=True):
        likely = np.flatnonzero(chances >= LEAST_ODDS * (1 - chances))
        if len(likely):
            told[row] = tuple(BASIC[term] for term in likely[np.argsort(-chances[likely])].tolist())
    return told


@dataclass(frozen=True, slots=True)
class Judged:
    """Who keeps the attributes, by object id, and which words nobody could judge.

    doubtful: the ids of those kept that are rather refused, where the step lists doubts.
    refused: the others; where nobody is kept, with their attributes who may hold them after all.
    """

    kept: dict[str, Candidate]
    unjudged: tuple[str, ...]
    doubtful: frozenset[str] = frozenset()
    refused: tuple[Candidate, ...] = ()


def judged(
    step: JudgeAttributes,
    found: Sequence[Candidate],
    looks_of: Callable[[Sequence[ObjectRecord]], Looks | None],
    lexicon: Lexicon,
) -> Judged:
    """Score the attributes of a step on the objects found; order and match stay.

    looks_of: reads the colours of objects; asked only where a colour is.
    """
    wanted, parts = without_parts(merged_shades(step.attributes), lexicon)
    colours = [word for word in wanted if is_colour(word)]
    scores: list[tuple[str, NDArray[np.float64], NDArray[np.bool_]]] = []
    unjudged: list[str] = list(parts)
    if colours:
        result = _colour(colours, found, looks_of)
        if result is None:
            unjudged += colours
        else:
            share = result[0] ** (1 / len(colours))  # the product is what holds for all of them
            scores += [(word, share, result[1]) for word in colours]
    for word in wanted:
        if word not in colours:
            sized = None if step.somewhere and word in _COMPARED else _size(word, found)
            _add(scores, unjudged, word, sized)
    for word in merged_shades(step.without):
        single = _colour([word], found, looks_of) if is_colour(word) else _size(word, found)
        opposite = None
        if single is not None:
            chance = 1 - single[0]
            opposite = (chance, chance >= LEAST_ODDS * single[0])
        _add(scores, unjudged, f"not {word}", opposite)
    return _told_apart(found, scores, tuple(unjudged), doubts=step.doubts)


def _told_apart(
    found: Sequence[Candidate],
    scores: Sequence[tuple[str, NDArray[np.float64], NDArray[np.bool_]]],
    unjudged: tuple[str, ...],
    *,
    doubts: bool,
) -> Judged:
    """Return who holds all of it, who may, and who does not; see `Judged`."""
    sure = _holding(found, scores)
    lists_more = doubts or not sure.any()
    maybe = _holding(found, _doubted(scores), least_once=0.0) if lists_more else sure
    listed = maybe if doubts else sure
    told = _with_attributes(found, scores, np.flatnonzero(maybe).tolist())
    kept = {(c := told[row]).record.object_id: c for row in np.flatnonzero(listed).tolist()}
    doubtful = [found[row].record.object_id for row in np.flatnonzero(listed & ~sure).tolist()]
    refused = [told.get(row, found[row]) for row in np.flatnonzero(~listed).tolist()]
    return Judged(kept, unjudged, frozenset(doubtful), tuple(refused))


def merged_shades(words: Sequence[str]) -> list[str]:
    """Return the attributes with two-word colours as one: dark, blue is "dark blue".

    Two basic colours stay two: a red orange ball is a colour, a red and orange one is not told
    apart here and is more often meant.
    """
    out: list[str] = []
    for word in words:
        both = f"{out[-1]} {word}" if out else ""
        if both and is_colour(both) and is_colour(word) and _qualifies(out[-1], word):
            out[-1] = both
        else:
            out.append(word)
    return out


def without_parts(words: Sequence[str], lexicon: Lexicon) -> tuple[list[str], list[str]]:
    """Return what is said of the thing, and what is said of a part of it ("white handle").

    The histogram of a box does not tell which pixels are the handle's.
    """
    whole: list[str] = []
    parts: list[str] = []
    for word in words:
        if lexicon.is_part(word):
            said = [whole.pop()] if len(whole) > 1 else []
            parts.append(" ".join([*said, word]))
        else:
            whole.append(word)
    return whole, parts


def _qualifies(first: str, second: str) -> bool:
    """Whether the first word tells which kind of the second colour is meant."""
    return not is_colour(first) or (
        first not in BASIC and second in BASIC and words_of(f"{first} {second}") != ()
    )


def _add(
    scores: list[tuple[str, NDArray[np.float64], NDArray[np.bool_]]],
    unjudged: list[str],
    word: str,
    result: tuple[NDArray[np.float64], NDArray[np.bool_]] | None,
) -> None:
    if result is None:
        unjudged.append(word)
    else:
        scores.append((word, *result))


def _colour(
    colours: Sequence[str],
    found: Sequence[Candidate],
    looks_of: Callable[[Sequence[ObjectRecord]], Looks | None],
) -> tuple[NDArray[np.float64], NDArray[np.bool_]] | None:
    """Return probability and tenability (n,), None where no object has a histogram."""
    looks = looks_of([candidate.record for candidate in found])
    if looks is None:
        return None
    verdict = looks.of_rows.judge(colours)
    probability = np.full(len(found), UNKNOWN)
    tenable = np.ones(len(found), dtype=np.bool_)
    probability[looks.rows] = verdict.probability
    tenable[looks.rows] = verdict.tenable
    return probability, tenable


def _size(
    word: str, found: Sequence[Candidate]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]] | None:
    """Return how likely each is noticeably big for its kind (n,).

    The usual is the median of the others that were seen more than once: of two, one is big beside
    the other. None for other words, too few sizes, and where all are about as large, by what was
    measured: then none is big and none small, and what was not measured says nothing.
    """
    if word not in _SIZES:
        return None
    measure, sign = _SIZES[word]
    extents = [c.record.extent_m for c in found]
    sizes = np.array([_measure(e, measure) if e else np.nan for e in extents], dtype=np.float64)
    known = ~np.isnan(sizes)
    sure = known & np.array([not c.record.tentative for c in found], dtype=np.bool_)
    telling = sure if int(sure.sum()) >= LEAST_SIZED else known
    if int(telling.sum()) < LEAST_SIZED:
        return None
    logs = np.log(np.maximum(sizes, 1e-3))
    usual = np.full(len(logs), np.median(logs[telling]))
    usual[telling] = medians_of_others(logs[telling])
    away = sign * (logs - usual)
    if np.abs(away[telling]).max() < NOTICED:
        return None
    told = normal_cdf((away[known] - NOTICED) / SIZE_SPREAD)
    probability = np.full(len(found), told.mean())
    probability[known] = told
    if word in _COMPARED:  # of several big ones none but the largest is the biggest
        behind = sign * logs - (sign * logs[telling]).max()
        largest = normal_cdf((np.minimum(behind, 0.0) + NOTICED) / SIZE_SPREAD)
        probability *= np.nan_to_num(largest) / normal_cdf(np.array(NOTICED / SIZE_SPREAD))
    return probability, probability >= LIKELIER


def medians_of_others(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return for each of two or more values (n,) the median of the others."""
    rank = np.argsort(np.argsort(values, kind="stable"), kind="stable")
    ordered, left = np.sort(values), len(values) - 1
    middle = np.array([(left - 1) // 2, left // 2])[:, None]  # where they are in what is left
    return np.asarray(ordered[middle + (rank <= middle)].mean(axis=0))


def _measure(extent: tuple[float, float], measure: str) -> float:
    width, height = extent
    if measure == "area":
        return float(np.sqrt(max(width * height, 0.0)))
    return height if measure == "height" else width


def _doubted(
    scores: Sequence[tuple[str, NDArray[np.float64], NDArray[np.bool_]]],
) -> list[tuple[str, NDArray[np.float64], NDArray[np.bool_]]]:
    """Return the scores with all tenable that is worth listing."""
    return [(word, p, tenable | (p >= LEAST_DOUBTFUL)) for word, p, tenable in scores]


def _holding(
    found: Sequence[Candidate],
    scores: Sequence[tuple[str, NDArray[np.float64], NDArray[np.bool_]]],
    least_once: float = LEAST_ONCE,
) -> NDArray[np.bool_]:
    """Return who holds all of it (n,); least_once: see LEAST_ONCE."""
    held = np.ones(len(found), dtype=np.bool_)
    least = np.ones(len(found))
    for _, p, tenable in scores:
        held &= tenable
        least = np.minimum(least, p)
    for row in np.flatnonzero(held & (least < least_once)).tolist():  # of thousands few
        held[row] = not found[row].record.tentative
    return held


def _with_attributes(
    found: Sequence[Candidate],
    scores: Sequence[tuple[str, NDArray[np.float64], NDArray[np.bool_]]],
    rows: Sequence[int],
) -> dict[int, Candidate]:
    """Return the candidates of some rows, by row, with how likely each attribute holds."""
    words = [word for word, _, _ in scores]
    held = np.array([p for _, p, _ in scores]).reshape(len(scores), len(found))[:, rows]
    told: dict[int, Candidate] = {}
    for row, each in zip(rows, np.clip(held, 0.0, 1.0).T.tolist(), strict=True):
        of = found[row]
        attributes = {**of.attributes, **dict(zip(words, each, strict=True))}
        told[row] = _candidate(of.record, of.match, attributes, of.same, of.votes)
    return told
