"""The SQL of every question to the SQLite store: pure functions, one native query each.

A time filter on closed intervals is `start <= b AND start >= a - longest AND end >= a`: the bound
turns a scan of the history into a range (34 -> 0.01 ms at 1 M places). It is read inside the
query, because another process may have raised it. The index is named in the query: a planner
without statistics picked another one, 20 to 200 times slower. An R*Tree answers with a superset
(32-bit floats, slack), so that positions and times are always checked again on the tables.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from typing import Any

from d3a.store.base import Area, SightingKey, StayKey
from d3a.store.rows import (
    ENCOUNTER_COLUMNS,
    LIGHT_OBJECT_COLUMNS,
    OBJECT_COLUMNS,
    SIGHTING_COLUMNS,
    STAY_COLUMNS,
    VIEW_COLUMNS,
    Row,
)
from d3a.store.schema import SLACK_M

_INDEX = re.compile(r"USING (?:COVERING )?INDEX (\w+)")
_KEY = re.compile(r"USING (INTEGER PRIMARY KEY|PRIMARY KEY)")
_TREE = re.compile(r"SCAN (\w+_tree) VIRTUAL TABLE INDEX")
FEW_IDS = 100
"""With no more ids than this all their stays are asked for, not all stays of an area."""
MANY_IDS = 1_000
"""With more ids than this and a bounded time, a walk through the time beats one look per id."""


@dataclass(slots=True)
class Select:
    """A query as it is put together: FROM, the conditions, and named parameters."""

    columns: str
    source: str
    order: str
    conditions: list[str] = field(default_factory=list)
    parameters: dict[str, Any] = field(default_factory=dict)

    def where(self, condition: str, **parameters: Any) -> None:
        """Add a condition with its parameters."""
        self.conditions.append(condition)
        self.parameters |= parameters

    def text(self) -> str:
        """Return the SQL."""
        where = f" WHERE {' AND '.join(self.conditions)}" if self.conditions else ""
        order = f" ORDER BY {self.order}" if self.order else ""
        return f"SELECT {self.columns} FROM {self.source}{where}{order}"


def among(column: str, parameter: str) -> str:
    """Return the condition that a column is in a list, see `as_list`."""
    return f"{column} IN (SELECT value FROM json_each(:{parameter}))"


def as_list(ids: Collection[Any]) -> str:
    """Return a list as the value of one parameter, however long it is."""
    return json.dumps(list(ids))


def columns_of(alias: str, columns: str) -> str:
    """Return the columns of a table's alias."""
    return ", ".join(f"{alias}.{name}" for name in columns.split(", "))


def touching(
    select: Select, alias: str, bound: str, start_ms: int | None, end_ms: int | None
) -> None:
    """Keep intervals of `alias` that touch the closed [start, end]; `bound` is their longest."""
    if end_ms is not None:
        select.where(f"{alias}.start_ms <= :end_ms", end_ms=end_ms)
    if start_ms is not None:
        longest = f"(SELECT value FROM internal WHERE key = '{bound}')"
        select.where(f"{alias}.start_ms >= :start_ms - {longest}", start_ms=start_ms)
        select.where(f"{alias}.end_ms >= :start_ms")


def _inside(select: Select, area: Area) -> None:
    """Keep the rows of `p` (stc) that lie in the area, exactly."""
    select.where("p.x >= :x_min AND p.x <= :x_max", x_min=area.x_min, x_max=area.x_max)
    select.where("p.y >= :y_min AND p.y <= :y_max", y_min=area.y_min, y_max=area.y_max)


def _tree_box(select: Select) -> None:
    select.where("x1 >= :x_min AND x0 <= :x_max AND y1 >= :y_min AND y0 <= :y_max")


def objects(
    ids: Sequence[str] | None,
    categories: Sequence[str] | None,
    names: Sequence[str] | None,
    *,
    votes: bool = False,
    embeddings: bool = True,
) -> Select:
    """Return the query of `Store.objects`."""
    select = Select(OBJECT_COLUMNS if embeddings else LIGHT_OBJECT_COLUMNS, "oic", "object_id")
    if ids is not None:
        select.where(among("object_id", "ids"), ids=as_list(ids))
    if categories is not None:
        called = among("category", "categories")
        if votes:
            voted = f"SELECT object_id FROM oic_vote WHERE {called}"
            called = f"({called} OR object_id IN ({voted}))"
        select.where(called, categories=as_list(categories))
    if names is not None:
        select.where(
            f"object_id IN (SELECT object_id FROM oic_name WHERE {among('word', 'names')})",
            names=as_list(names),
        )
    return select


def embeddings() -> Select:
    """Return the query of `Store.embeddings`."""
    return Select("object_id, embedding", "oic", "object_id", ["embedding IS NOT NULL"])


def stays(
    object_ids: Sequence[str] | None,
    area: Area | None,
    start_ms: int | None,
    end_ms: int | None,
    *,
    trees: bool,
) -> Select:
    """Return the query of `Store.stays`."""
    columns, order = columns_of("p", STAY_COLUMNS), "p.object_id, p.place"
    if object_ids is not None:
        select = Select(columns, "stc p", order)
        select.where(among("p.object_id", "ids"), ids=as_list(object_ids))
    elif area is not None:
        select = _stays_in_box(columns, order, trees=trees)
    elif start_ms is not None:
        select = Select(columns, "stc p INDEXED BY stc_last", order)
    else:
        select = Select(columns, "stc p", order)
    if area is not None:
        _inside(select, area)
    if start_ms is not None:
        select.where("p.last_ms >= :start_ms", start_ms=start_ms)
    if end_ms is not None:
        select.where("p.first_ms <= :end_ms", end_ms=end_ms)
    return select


def stays_at(keys: Sequence[StayKey]) -> Select:
    """Return the query of `Store.stays_at`: keys in order, none twice."""
    source = (
        "json_each(:keys) j CROSS JOIN stc p "
        "ON p.object_id = json_extract(j.value, '$[0]') AND p.place = json_extract(j.value, '$[1]')"
    )
    select = Select(columns_of("p", STAY_COLUMNS), source, "p.object_id, p.place")
    select.parameters["keys"] = as_list(keys)
    return select


def stays_of_rows(row_ids: Sequence[int]) -> Select:
    """Return the query of the stays with these row ids, in their order."""
    source = "json_each(:rows) j CROSS JOIN stc p ON p.stay_id = j.value"
    return Select(columns_of("p", STAY_COLUMNS), source, "", [], {"rows": as_list(row_ids)})


def _stays_in_box(columns: str, order: str, *, trees: bool) -> Select:
    if trees:
        select = Select(columns, "stc_tree CROSS JOIN stc p ON p.stay_id = stc_tree.id", order)
        _tree_box(select)
        return select
    select = Select(columns, "stc p INDEXED BY stc_x", order)
    select.where("p.tree_x >= :x_min - :slack AND p.tree_x <= :x_max + :slack", slack=SLACK_M)
    return select


def sightings(
    object_ids: Sequence[str] | None,
    area: Area | None,
    start_ms: int | None,
    end_ms: int | None,
    *,
    trees: bool,
) -> Select:
    """Return the query of `Store.sightings`.

    By ids, else by the box (with time: the tree of x, y, t; without: the tree of places), else
    by time.
    """
    columns, order = columns_of("s", SIGHTING_COLUMNS), "s.start_ms, s.object_id, s.place"
    timed = start_ms is not None or end_ms is not None
    many = object_ids is not None and len(object_ids) > MANY_IDS and timed
    if object_ids is not None and not many:
        select = Select(columns, "sighting s INDEXED BY sighting_object_start", order)
    elif area is None:
        select = Select(columns, "sighting s INDEXED BY sighting_start", order)
    elif timed and trees:
        select = _sightings_in_box(columns, order, start_ms, end_ms)
    else:
        select = _stays_in_box(columns, order, trees=trees)
        select.source += " CROSS JOIN sighting s ON s.stay_id = p.stay_id"
    if object_ids is not None:
        column = "+s.object_id" if many else "s.object_id"
        select.where(among(column, "ids"), ids=as_list(object_ids))
    if area is not None:
        if " p" not in select.source:
            select.source += " CROSS JOIN stc p ON p.stay_id = s.stay_id"
        _inside(select, area)
    touching(select, "s", "max_sighting_ms", start_ms, end_ms)
    return select


def _sightings_in_box(columns: str, order: str, start_ms: int | None, end_ms: int | None) -> Select:
    source = "sighting_tree CROSS JOIN sighting s ON s.id = sighting_tree.id"
    select = Select(columns, source, order)
    base = "(SELECT value FROM internal WHERE key = 'tree_base_ms')"
    _tree_box(select)
    if start_ms is not None:
        select.where(f"t1 >= (:start_ms - {base}) / 1000.0")
    if end_ms is not None:
        select.where(f"t0 <= (:end_ms - {base}) / 1000.0")
    return select


def spans(
    object_ids: Sequence[str],
    area: Area | None,
    start_ms: int | None,
    end_ms: int | None,
    *,
    trees: bool,
) -> Select:
    """Return the query of what `Store.spans` tells: from an index alone, or the stays of an area.

    See `of_each` for how it is read.
    """
    columns = order = "s.object_id, s.start_ms, s.end_ms, s.place"
    if area is None:
        select = Select(columns, "sighting s INDEXED BY sighting_object_start", order)
        select.where(among("s.object_id", "ids"), ids=as_list(object_ids))
    else:
        few, timed = len(object_ids) <= FEW_IDS, start_ms is not None and end_ms is not None
        if timed and trees and not few:
            select = _sightings_in_box(columns, order, start_ms, end_ms)
            select.source += " CROSS JOIN stc p ON p.stay_id = s.stay_id"
        else:
            select = Select(columns, "stc p", order)
            if not few:
                select = _stays_in_box(columns, order, trees=trees)
            select.source += " CROSS JOIN sighting s ON s.stay_id = p.stay_id"
        select.where(among(f"{'' if few else '+'}p.object_id", "ids"), ids=as_list(object_ids))
        _inside(select, area)
    touching(select, "s", "max_sighting_ms", start_ms, end_ms)
    return select


def positions(object_ids: Sequence[str]) -> Select:
    """Return the query of `Store.positions`."""
    columns = "object_id, place, x, y, z, site, covariance"
    select = Select(columns, "stc", "object_id, place")
    select.where(among("object_id", "ids"), ids=as_list(object_ids))
    return select


def of_each(select: Select, limit: int | None) -> Select:
    """Return the query that gives an object a text where one of `spans` gives a sighting a row.

    Its numbers are in no order. limit: only so many sightings, in the order of `Store.spans`.
    """
    columns = "object_id, group_concat(start_ms || ' ' || end_ms || ' ' || place, ' ')"
    if limit is None:
        select.order = ""
    inner = select.text() + ("" if limit is None else " LIMIT :limit")
    given = select.parameters | ({} if limit is None else {"limit": limit})
    return Select(columns, f"({inner}) GROUP BY object_id", "", [], given)


def sightings_at(keys: Collection[SightingKey]) -> Select:
    """Return the query of `Store.sightings_at`: keys, none twice."""
    source = (
        "json_each(:keys) j CROSS JOIN stc p "
        "ON p.object_id = json_extract(j.value, '$[0]') AND p.place = json_extract(j.value, '$[1]')"
        " CROSS JOIN sighting s "
        "ON s.stay_id = p.stay_id AND s.start_ms = json_extract(j.value, '$[2]')"
    )
    order = "s.start_ms, s.object_id, s.place"
    select = Select(columns_of("s", SIGHTING_COLUMNS), source, order)
    select.parameters["keys"] = as_list(keys)
    return select


def seen(object_ids: Sequence[str], start_ms: int | None, end_ms: int | None) -> Select:
    """Return the query of `Store.count_seen`: one step into an index per object, by id."""
    inner = Select("1", "sighting q INDEXED BY sighting_object_start", "")
    inner.where("q.object_id = j.value")
    touching(inner, "q", "max_sighting_ms", start_ms, end_ms)
    select = Select("count(*)", "json_each(:ids) j", "", [f"EXISTS ({inner.text()})"])
    select.parameters = {"ids": as_list(object_ids), **inner.parameters}
    return select


def seen_within(object_ids: Sequence[str], start_ms: int, end_ms: int) -> Select:
    """Return the query of `Store.count_seen` for many objects: a walk through the time.

    What starts within touches it: only what started before is looked up for its end.
    """
    source = "sighting q INDEXED BY sighting_start"
    within = Select("q.object_id", source, "")
    within.where(among("+q.object_id", "ids"), ids=as_list(object_ids))
    within.where("q.start_ms BETWEEN :start_ms AND :end_ms", start_ms=start_ms, end_ms=end_ms)
    before = Select("q.object_id", source, "", [within.conditions[0], "q.start_ms < :start_ms"])
    touching(before, "q", "max_sighting_ms", start_ms, None)
    both = f"({within.text()} UNION {before.text()})"
    return Select("count(*)", both, "", [], within.parameters)


def starts(object_ids: Sequence[str], before: int, *, oldest: bool) -> Select:
    """Return the query of `Store.reach`: from an index alone. before: so many come before it."""
    order = f"s.start_ms {'' if oldest else 'DESC'} LIMIT 1 OFFSET :before"
    select = Select("s.start_ms", "sighting s INDEXED BY sighting_object_start", order)
    select.where(among("s.object_id", "ids"), ids=as_list(object_ids), before=before)
    return select


def edges(
    object_ids: Sequence[str], which: str, before_ms: int | None, after_ms: int | None
) -> Select:
    """Return the query of `Store.edges`: one step into an index per object."""
    if which == "last":
        index, order = "sighting_object_end", "q.end_ms DESC, q.start_ms DESC, q.place DESC"
    else:
        index, order = "sighting_object_start", "q.start_ms, q.end_ms, q.place"
    inner = Select("q.id", f"sighting q INDEXED BY {index}", order)
    inner.where("q.object_id = j.value")
    touching(inner, "q", "max_sighting_ms", after_ms, before_ms)
    if before_ms is not None and which == "last":
        longest = "(SELECT value FROM internal WHERE key = 'max_sighting_ms')"
        inner.where(f"q.end_ms <= :end_ms + {longest}")  # so that later sightings are not walked
    source = f"json_each(:ids) j CROSS JOIN sighting s ON s.id = ({inner.text()} LIMIT 1)"
    select = Select(columns_of("s", SIGHTING_COLUMNS), source, "s.object_id")
    select.parameters = {"ids": as_list(sorted(set(object_ids))), **inner.parameters}
    return select


def encounters(
    object_ids: Sequence[str] | None,
    with_ids: Sequence[str] | None,
    start_ms: int | None,
    end_ms: int | None,
) -> Select:
    """Return the query of `Store.encounters`, driven by the smaller of the two lists."""
    order = "e.start_ms, e.object_a, e.object_b, e.place_a, e.place_b"
    columns = columns_of("e", ENCOUNTER_COLUMNS)
    few, more = sorted(
        (object_ids, with_ids), key=lambda ids: (ids is None, 0 if ids is None else len(ids))
    )
    if few is None:
        select = Select(columns, "encounter e INDEXED BY encounter_start", order)
        touching(select, "e", "max_encounter_ms", start_ms, end_ms)
        return select
    arms = []
    parameters: dict[str, Any] = {"ids": as_list(few)}
    for mine, other in (("a", "b"), ("b", "a")):
        arm = Select("q.id", f"encounter q INDEXED BY encounter_{mine}", "1")
        arm.where(among(f"q.object_{mine}", "ids"))
        if more is not None:
            arm.where(among(f"+q.object_{other}", "more"), more=as_list(more))
        touching(arm, "q", "max_encounter_ms", start_ms, end_ms)
        parameters |= arm.parameters
        arms.append(arm.text().removesuffix(" ORDER BY 1"))
    select = Select(columns, "encounter e", order)
    select.where(f"e.id IN ({' UNION ALL '.join(arms)})", **parameters)
    return select


def views(start_ms: int | None, end_ms: int | None) -> Select:
    """Return the query of `Store.views`."""
    select = Select(VIEW_COLUMNS, "seen_area v", "start_ms, end_ms, site, recording")
    touching(select, "v", "max_view_ms", start_ms, end_ms)
    return select


def index_of(plan: list[Row]) -> str | None:
    """Return the indexes and trees that a query plan names, in its order, none twice.

    A primary key is named where nothing else leads the query.
    """
    details = [row[-1] for row in plan]
    for patterns in ((_INDEX, _TREE), (_KEY,)):
        found = [name for text in details for p in patterns for name in p.findall(text)]
        if found:
            return ", ".join(dict.fromkeys(found))
    return None
