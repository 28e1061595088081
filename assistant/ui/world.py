"""What the chat knows of the store beside its answers: for the header, the map, the first screen.

It is read once when the chat opens, and what people taught since with each answer.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace

from assistant.session import Session, known_words
from assistant.starters import starters
from assistant.ui.floor import Floor, read_floor
from d3a.constraints import SAID
from d3a.model import D3AError
from d3a.store.base import Region, Store

EMPTY_FLOOR = Floor()


@dataclass(frozen=True, slots=True)
class News:
    """What is new in the store: seen since, or taught since; None for what is as it was.

    lessons: the count of what people said, as `World` has it.
    """

    newest_ms: int | None = None
    lessons: int | None = None
    regions: tuple[Region, ...] | None = None
    words: tuple[str, ...] | None = None


@dataclass(frozen=True, slots=True)
class World:
    """What a store holds. lessons: how often people taught it something, or took it back."""

    floor: Floor = EMPTY_FLOOR
    words: tuple[str, ...] = ()
    questions: tuple[str, ...] = ()
    newest_ms: int | None = None
    lessons: int | None = None
    problem: str | None = None

    def after(self, news: News) -> World:
        """Return the world with what is new."""
        return replace(
            self,
            floor=self.floor if news.regions is None else replace(self.floor, regions=news.regions),
            words=self.words if news.words is None else news.words,
            newest_ms=news.newest_ms or self.newest_ms,
            lessons=news.lessons or self.lessons,
        )


def survey(session: Session) -> Iterator[World]:
    """Look at a store, and yield what is known of it after each step; the last is all.

    The questions to start from come last, one a step. What fails is told as the world's problem.
    """
    store = session.store
    try:
        world = World(
            floor=read_floor(store),
            words=known_words(store),
            newest_ms=store.last_view_ms(),
            lessons=store.meta(SAID),
        )
        yield world
        for question in starters(session):
            if question is not None:
                world = replace(world, questions=(*world.questions, question))
            yield world
    except D3AError as error:
        yield World(problem=str(error))
    except Exception as error:  # a chat outlives a defect, and shows it
        yield World(problem=f"{type(error).__name__}: {error}")


def in_turn(steps: Iterator[World], lane: AbstractContextManager[object]) -> Iterator[World]:
    """Take each step within `lane`, and leave it to others in between."""
    while True:
        with lane:
            step = next(steps, None)
        if step is None:
            return
        yield step


def read_news(store: Store, world: World) -> News:
    """Return what came since a world was read; nothing where the store cannot be asked."""
    try:
        newest_ms, lessons = store.last_view_ms(), store.meta(SAID)
        if lessons == world.lessons:
            return News(newest_ms)
        return News(newest_ms, lessons, tuple(store.regions()), known_words(store))
    except D3AError:  # the answer is there already; the rest stays as it was
        return News()
