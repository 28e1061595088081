"""Everything in the home that a detector can see: home.toml, read and given its solids."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from importlib.resources import files
from typing import Any

from assistant.home import furniture, tableware, things
from assistant.home.life import Place, Stays, Thing, when
from assistant.home.model import Model

LOOKS: Mapping[str, Callable[..., Model]] = {
    look.__name__: look
    for look in (
        *(furniture.bed, furniture.bench, furniture.bookcase, furniture.chair, furniture.couch),
        *(furniture.counter, furniture.fridge, furniture.microwave, furniture.nightstand),
        *(furniture.oven, furniture.sideboard, furniture.sink, furniture.table),
        *(furniture.television, furniture.wardrobe),
        *(tableware.apple, tableware.banana, tableware.bowl, tableware.cup, tableware.kettle),
        *(tableware.toaster, tableware.vase, tableware.water_bottle, tableware.wine_bottle),
        *(things.backpack, things.book, things.clock, things.glasses, things.handbag),
        *(things.keys, things.lamp, things.laptop, things.phone, things.pillow, things.plant),
        *(things.remote, things.scissors, things.teddy, things.wallet),
    )
}


def inventory() -> tuple[Thing, ...]:
    """Return the home's things in the order of home.toml."""
    text = (files("assistant.home") / "home.toml").read_text(encoding="utf-8")
    return tuple(_thing(record) for record in tomllib.loads(text)["thing"])


def _thing(record: Mapping[str, Any]) -> Thing:
    look, *arguments = record["look"]
    return Thing(
        name=record["name"],
        category=record["category"],
        colour=record["colour"],
        model=LOOKS[look](*arguments),
        stays=_stays(record["stays"]),
    )


def _stays(rows: list[list[Any]]) -> Stays:
    """Return (from when, where) of each row; a row of a time alone is away."""
    return tuple((when(since), Place(*place) if place else None) for since, *place in rows)
