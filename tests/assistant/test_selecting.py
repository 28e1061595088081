"""What a description on the command line may say of things that are forgotten or exported."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from assistant.asking import ask
from assistant.cli import main
from assistant.selecting import Meant, NothingMeant, clearly_meant, unused
from d3a.answer import RankedKeyframe
from d3a.store import open_store
from grammar import parse
from grammar.forms import Correction, FormalQuery, ObjectTerm, Relation, TimeSlice, Where
from tests.worlds import small_home

Run = Callable[..., Result]
HOME = ("--store", "home.db", "--now", small_home.NOW.isoformat())
TOO_MUCH = [
    ("the keys today", "“today”"),
    ("the cup on the desk", "“on the desk”"),
    ("the keys on the kitchen table", "“on the kitchen table”"),
    ("the keys in the bathroom", "“in the bathroom”"),
    ("the keys in the kitchen", "“in the kitchen”"),
    ("the cup outside the kitchen", "“outside the kitchen”"),
    ("two cups", "“two”"),
    ("at most two cups", "“at most two”"),
    ("the first cup", "“first”"),
    ("the last cup", "“last”"),
    ("the other cup", "“other”"),
    ("two cups on the couch", "“two” and “on the couch”"),
    ("the cup that was next to the bowl yesterday", "“that was next to the bowl yesterday”"),
    ("the cup and the bowl", "“and the bowl”"),
    ("the cup that is not red", "“that is not red”"),
    ("the cup that is not Anna's", "“that is not Anna”"),
    ("no cup", "“no”"),
    ("the thing", "“thing”, which is everything"),
    ("Anna's cup", "nobody taught which thing is so owned"),
    ("my cup", "nobody taught which thing is so owned"),
    ("the wooden cup", "this store cannot tell what is “wooden”"),
]


@pytest.fixture
def run(own_settings: Path) -> Run:
    """Run `d3a` in a folder with the small home as `home.db`, with settings of its own."""
    with closing(open_store("home.db")) as store:
        small_home.fill(store)
    return lambda *args, **options: CliRunner().invoke(main, list(args), **options)


def ids() -> set[str]:
    with closing(open_store("home.db")) as store:
        return {record.object_id for record in store.objects()}


@pytest.mark.parametrize(("words", "found"), TOO_MUCH)
def test_what_cannot_be_used_is_refused_and_nothing_goes(run: Run, words: str, found: str) -> None:
    before = ids()
    for how in ("--yes", "--dry-run"):
        result = run("forget", *words.split(), *HOME, how)
        assert (result.exit_code, result.stdout) == (2, ""), result.output
        assert found in result.stderr
        assert "`d3a objects`" in result.stderr
    assert ids() == before
    result = run("export", "out.csv", "--format", "csv", "--what", words, *HOME)
    assert (result.exit_code, found in result.stderr) == (2, True), result.output
    assert not Path("out.csv").exists()


def test_a_refusal_says_which_options_say_where_and_when(run: Run) -> None:
    said = run("forget", "the keys today", *HOME, "--yes").stderr
    assert "--place, --before, --after and --between" in said


@pytest.mark.parametrize("words", ["cup", "the cups", "all cups", "every cup", "mug", "cup-1"])
def test_plain_things_go(run: Run, words: str) -> None:
    before = ids()
    result = run("forget", *words.split(), *HOME, "--yes")
    assert result.exit_code == 0, result.output
    assert before - ids() == {"cup-1"}


@pytest.mark.parametrize("words", ["drinkware", "all drinkware"])
def test_a_wider_word_means_its_kinds_and_names_them_first(run: Run, words: str) -> None:
    before = ids()
    shown = run("forget", *words.split(), *HOME, "--dry-run")
    assert "cup-1" in shown.stdout, shown.output
    assert ids() == before
    result = run("forget", *words.split(), *HOME, "--yes")
    assert before - ids() == {
        line.split()[0] for line in shown.stdout.splitlines()[2:] if "-" in line
    }
    assert result.exit_code == 0


def test_what_is_wider_than_the_word_is_not_meant(run: Run) -> None:
    before = ids()
    for words in ("espresso cup", "fruit"):
        assert run("forget", *words.split(), *HOME, "--yes").exit_code == 1
    assert ids() == before


@pytest.mark.parametrize(
    ("taught", "words", "gone"),
    [
        ("Anna's cup", "Anna's cup", True),
        ("Anna's cup", "the cup of Anna", True),
        ("Anna's cup", "Bob's cup", False),
        ("Anna's cup", "my cup", False),
        ("my cup", "my cup", True),
        ("my cup", "Anna's cup", False),
        ("Anna's", "Anna's cup", True),
        ("mine", "my cup", True),
        ("Excalibur", "Excalibur", True),
        ("cup", "my cup", True),
        ("cup", "Anna's cup", False),
    ],
)
def test_an_owner_counts_where_it_was_taught(run: Run, taught: str, words: str, gone: bool) -> None:
    assert run("teach", "cup-1", taught, *HOME).exit_code == 0
    result = run("forget", words, *HOME, "--yes")
    assert (result.exit_code == 0, "cup-1" not in ids()) == (gone, gone), result.output


OTHER = ObjectTerm("desk")


@pytest.mark.parametrize(
    "more",
    [
        {"place": "kitchen"},
        {"place": "kitchen", "outside": True},
        {"time": TimeSlice(small_home.NOW - timedelta(days=1), small_home.NOW)},
        {"select": "first"},
        {"negated": True},
        {"relation": Relation("on")},
        {"objects": (ObjectTerm("cup"), OTHER)},
        {"objects": ()},
        {"objects": (ObjectTerm("cup", quantity=2),)},
        {"objects": (ObjectTerm("cup", quantity=2, bound="exactly"),)},
        {"objects": (ObjectTerm("cup", without=("red",)),)},
        {"objects": (ObjectTerm("cup", not_owner="anna"),)},
        {"objects": (ObjectTerm("cup", where=Where("on", OTHER)),)},
        {"corrections": (Correction("cop", "cup", 0),)},
        {"ask": "count"},
        {"form": "Q3"},
    ],
    ids=str,
)
def test_every_other_field_of_a_query_is_refused(more: dict[str, Any]) -> None:
    query: FormalQuery = parse("Did you ever see the cup?", now=small_home.NOW)
    assert unused(query, "the cup") == ""
    assert unused(replace(query, **more), "the cup")


@pytest.fixture
def cup(run: Run) -> RankedKeyframe:
    """Return the row of the small home's cup."""
    with closing(open_store("home.db")) as store:
        (row,) = ask(store, "Did you see a cup?", now=small_home.NOW).keyframes
    return row


def looking(row: RankedKeyframe, object_id: str, chance: float, score: float) -> RankedKeyframe:
    """Return the row as of another thing, with a chance of its look and a score."""
    why = {**row.why, "attributes": {"red": chance}}
    return replace(row, object_id=object_id, score=score, why=why)


def test_what_hardly_looks_as_described_is_kept_and_told(cup: RankedKeyframe) -> None:
    rows = [
        looking(cup, "o1", 0.97, 0.9),
        looking(cup, "o2", 0.9, 0.1),  # seen once, and red
        looking(cup, "o3", 0.34, 0.57),  # likely after all, as an answer would tell
        looking(cup, "o4", 0.1, 0.2),
        looking(cup, "o4", 0.1, 0.1),
    ]
    assert clearly_meant("red thing", rows) == Meant(frozenset(("o1", "o2", "o3")), ("cup o4",))
    with pytest.raises(NothingMeant, match=r"surely 'red thing'.* cup o4"):
        clearly_meant("red thing", rows[3:])
    assert clearly_meant("cup", [replace(cup, score=0.05)]).ids == {"cup-1"}
