"""A home of three rooms and four things, and canned answers: a fixed world for screens."""

from __future__ import annotations

import io
from collections.abc import Callable
from datetime import datetime, timedelta
from zoneinfo import ZoneInfo

from PIL import Image, ImageDraw

from assistant.session import Session
from d3a.answer import Answer, RankedKeyframe
from d3a.store.base import (
    Batch,
    Encounter,
    Keyframe,
    ObjectRecord,
    Region,
    Sighting,
    StayRecord,
    Store,
    View,
)
from grammar.forms import FormalQuery, ObjectTerm

ZONE = ZoneInfo("America/New_York")
NOW = datetime(2026, 3, 1, 19, 0, tzinfo=ZONE)
WIDTH, HEIGHT = 320, 180
BOX = (60.0, 100.0, 120.0, 140.0)
NASTY = "mug [red]\x1b[31m[/]\u202e"
"""A category name with markup, an escape, and a reversed direction."""


def ms(moment: datetime) -> int:
    return int(moment.timestamp() * 1000)


def jpeg(hue: tuple[int, int, int]) -> bytes:
    """Return a picture: a table, a wall, and a thing of one colour where `BOX` is."""
    image = Image.new("RGB", (WIDTH, HEIGHT), (200, 205, 210))
    draw = ImageDraw.Draw(image)
    draw.rectangle((0, 120, WIDTH, HEIGHT), fill=(120, 80, 40))
    draw.rectangle((220, 20, 300, 90), fill=(90, 140, 190))
    draw.ellipse(BOX, fill=hue)
    written = io.BytesIO()
    image.save(written, "JPEG", quality=85)
    return written.getvalue()


PICTURES = {"p1": (210, 160, 30), "p2": (40, 90, 200), "p3": (60, 160, 60)}
SEEN = (
    # object, category, x, y, hours before NOW, picture
    ("keys-1", "keys", 6.0, 1.5, 9.3, "p1"),
    ("keys-1", "keys", 1.0, 3.5, 10.75, "p2"),
    ("keys-1", "keys", 6.2, 3.6, 50.0, "p3"),
    ("cup-1", "cup", 6.1, 1.4, 9.2, "p2"),
    ("bowl-1", "bowl", 6.4, 1.6, 9.2, "p3"),
    ("couch-1", "couch", 2.0, 1.0, 20.0, None),
)


def fill(store: Store, *, site: str = "lab") -> None:
    """Put the home into a store."""
    stays, sightings = [], []
    objects: dict[str, ObjectRecord] = {}
    for place, (thing, category, x, y, hours, picture) in enumerate(SEEN):
        at = ms(NOW - timedelta(hours=hours))
        stays.append(StayRecord(thing, place, (x, y, 0.8), at, at, 1.0, site=site))
        sightings.append(
            Sighting(thing, place, at, at, f"{place:06d}", 0.8, BOX, picture, category=category)
        )
        first = min(at, objects[thing].first_ms) if thing in objects else at
        last = max(at, objects[thing].last_ms) if thing in objects else at
        objects[thing] = ObjectRecord(thing, category, 3.0, first, last, site=site)
    seen = ms(NOW - timedelta(minutes=8))
    together = ms(NOW - timedelta(hours=9.2))
    store.apply(
        Batch(
            objects=list(objects.values()),
            stays=stays,
            sightings=sightings,
            encounters=[
                Encounter("bowl-1", "cup-1", 4, 3, together, together, "000003", BOX, BOX, 0.7)
            ],
            views=[View(seen, seen, 1, site=site, x=3.0, y=1.0, yaw=0.0)],
            keyframes=[
                Keyframe(key, jpeg(hue), WIDTH, HEIGHT, seen) for key, hue in PICTURES.items()
            ],
            regions=[
                Region("lab", ((0, 0), (4, 0), (4, 2.5), (0, 2.5))),
                Region("hall", ((0, 2.5), (4, 2.5), (4, 5), (0, 5))),
                Region("kitchen", ((4, 0), (8, 0), (8, 5), (4, 5))),
            ],
            meta={"zone": ZONE.key},
        )
    )


def keyframe(rank: int, *, category: str = "keys", score: float = 0.7) -> RankedKeyframe:
    """Return the keyframe of the keys at their `rank`-th place."""
    thing, _, x, y, hours, picture = SEEN[rank - 1]
    at = NOW - timedelta(hours=hours)
    return RankedKeyframe(
        rank=rank,
        score=score,
        object_id=thing,
        category=category,
        frame=f"{rank - 1:06d}",
        probability=0.8,
        box=BOX,
        start=at,
        end=at,
        position=(x, y, 0.8),
        place=("kitchen", "hall", "kitchen")[rank - 1],
        near=("table", "door", "sofa")[rank - 1],
        seen=(14, 3, 1)[rank - 1],
        image=picture,
        why={"match": 1.0, "attributes": {"brass": 0.5}, "detection": 0.8},
    )


def found(text: str, *, category: str = "keys") -> Answer:
    """Return the answer of three keyframes."""
    return Answer(
        text=text,
        answer="On the kitchen table. I last saw them today at 9:42, 9 hours ago.",
        query=FormalQuery(text, "Q3", "where", (ObjectTerm("keys"),), select="last"),
        count=1,
        keyframes=tuple(
            keyframe(rank, category=category, score=score)
            for rank, score in ((1, 0.7), (2, 0.4), (3, 0.1))
        ),
        last_looked=NOW - timedelta(minutes=8),
        elapsed_ms={"parse": 0.4, "total": 2.2},
    )


def answer(text: str) -> Answer:
    """Return a canned answer by the question's words."""
    if "wallet" in text:
        return Answer(
            text=text,
            status="unknown_object",
            reason="never",
            answer="I do not know wallets.",
            suggestions=("Where is the bag?", "Where are the keys?"),
        )
    if "mug" in text:
        return found(text, category=NASTY)
    if "yesterday" in text:
        return Answer(
            text=text,
            status="not_found",
            reason="not_then",
            answer="Not then; on Friday at 17:00.",
            otherwise=keyframe(3),
        )
    if "never" in text:
        return Answer(text=text, status="not_found", reason="never", answer="I never saw one.")
    return found(text)


def session(store: Store, ask: Callable[[str], Answer] = answer, **changes: object) -> Session:
    """Return a session over a filled store, with canned answers."""
    parts: dict[str, object] = {
        "store": store,
        "ask": ask,
        "explain": lambda text: f"query   keys(x)\nplan\n  1. find [keys] of {text}",
        "now": lambda: NOW,
        "title": "lab",
    }
    return Session(**(parts | changes))  # type: ignore[arg-type]  # a test's own mixture
