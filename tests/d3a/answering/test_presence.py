"""What is so still, what a noun with a room means, rare words, unions and landmarks."""

from __future__ import annotations

from dataclasses import replace

import pytest

from d3a.answer import Answer
from d3a.execute import execute
from d3a.parameters import DEFAULT, PAPER, Parameters
from d3a.plan import Precision, plan
from grammar.forms import FormalQuery, ObjectTerm, Relation, RelationKind, Select
from tests.worlds.made import NOW, Box, Home, Words
from tests.worlds.oracle import OracleStore

ON, UNDER = (180.0, 170.0, 220.0, 230.0), (100.0, 200.0, 300.0, 400.0)
THING, CUP, KEY = ObjectTerm("object"), ObjectTerm("cup"), ObjectTerm("key")


def run(
    home: Home,
    asked: FormalQuery,
    *,
    parameters: Parameters = DEFAULT,
    precision: Precision | None = None,
) -> Answer:
    steps = plan(asked, parameters=parameters, precision=precision)
    store = home.into(OracleStore())
    return execute(steps, store, Words(), now=NOW, limit=50, parameters=parameters)


def ids(answer: Answer) -> set[str]:
    return {keyframe.object_id for keyframe in answer.keyframes if keyframe.category != "table"}


def on_table(*, word: str = "table", figure: ObjectTerm = THING, now: bool = True) -> FormalQuery:
    ground = ObjectTerm(word if word == "table" else "table", word)
    select: Select = "last" if now else "all"
    return FormalQuery("?", "Q2", "what", (figure, ground), Relation("on"), select=select)


def lay(home: Home, name: str, table: str, minute: float, x: float) -> None:
    home.seen(name, minute, minute + 5, at=(x, 1, 1), box=ON)
    home.met(name, table, minute, minute + 5, boxes=(ON, UNDER))


@pytest.fixture
def home() -> Home:
    home = Home()
    home.room("kitchen", -1, -1, 3, 3)
    home.room("hall", 5, -1, 9, 3)
    for name, x in (("table", 1.0), ("table-hall", 7.0)):
        home.thing(name, "table")
        home.seen(name, 0, 300, at=(x, 1, 0.7), box=UNDER)
    home.thing("cup", "cup", paint="red")
    home.thing("bowl", "bowl", paint="orange")
    home.thing("keys", "key", paint="black")
    lay(home, "cup", "table", 10, 1.0)
    lay(home, "bowl", "table", 20, 1.2)
    lay(home, "keys", "table-hall", 30, 7.0)
    return home


def test_what_lies_there_still_and_what_ever_did(home: Home) -> None:
    home.seen("cup", 100, 110, at=(6, -0.5, 0), place=1)  # carried off since
    assert ids(run(home, on_table())) == {"bowl", "keys"}
    assert ids(run(home, on_table(now=False))) == {"bowl", "keys", "cup"}


def test_a_place_seen_empty_since_holds_nothing(home: Home) -> None:
    home.seen("bowl", 20, 25, at=(1.2, 1, 1), absent=200, box=ON)
    assert ids(run(home, on_table())) == {"cup", "keys"}
    asked = replace(on_table(figure=ObjectTerm("bowl")), ask="whether")
    answer = run(home, asked)
    assert (answer.status, answer.reason) == ("not_found", "gone")
    assert answer.otherwise is not None
    assert answer.otherwise.object_id == "bowl"


def test_what_was_seen_elsewhere_since_is_told_from_there(home: Home) -> None:
    home.seen("cup", 100, 110, at=(6, -0.5, 0), place=1)
    answer = run(home, replace(on_table(figure=CUP), ask="whether"))
    assert answer.reason == "gone"
    assert answer.otherwise is not None
    assert answer.otherwise.place == "hall"


def test_one_s_own_thing_is_where_its_newest_likeness_was(home: Home) -> None:
    home.thing("keys-again", "key", paint="black")
    home.seen("keys-again", 200, 205, at=(2, -0.5, 0))
    asked = replace(on_table(figure=KEY), ask="whether")
    assert run(home, asked).status == "found"
    mine = replace(asked, objects=(replace(KEY, owner="me"), asked.objects[1]))
    answer = run(home, mine)
    assert answer.reason == "gone"
    assert answer.otherwise is not None
    assert answer.otherwise.object_id == "keys-again"


def test_a_thing_seen_again_at_its_place_is_told_by_that(home: Home) -> None:
    home.seen("bowl", 250, 255, at=(1.2, 1, 1))
    answer = run(home, replace(on_table(figure=ObjectTerm("bowl")), ask="whether"))
    assert answer.status == "found"
    assert answer.keyframes[0].end == NOW.replace(hour=16, minute=15)


def test_a_ground_that_was_carried_off_ends_it_too(home: Home) -> None:
    together = FormalQuery(
        "?", "Q2", "whether", (CUP, ObjectTerm("bowl")), Relation("together"), select="last"
    )
    home.seen("cup", 20, 25, at=(1, 1, 1))
    home.met("cup", "bowl", 20, 25)
    assert run(home, together).status == "found"
    home.seen("bowl", 100, 105, at=(7, 2, 1), place=1)
    assert run(home, together).reason == "gone"


def test_the_table_of_a_room(home: Home) -> None:
    assert ids(run(home, on_table(word="kitchen table"))) == {"cup", "bowl"}
    assert ids(run(home, on_table(word="hall table"))) == {"keys"}


def test_a_room_without_the_thing_leaves_what_is_called_so(home: Home) -> None:
    home.room("cellar", 20, 20, 25, 25)
    home.thing("odd", "cellar table")
    home.seen("odd", 0, 300, at=(1.3, 1, 0.7), box=UNDER)
    home.met("bowl", "odd", 20, 25, boxes=(ON, UNDER))
    asked = on_table(word="cellar table", now=False)
    asked = replace(asked, objects=(THING, ObjectTerm("cellar table")))
    assert ids(run(home, asked)) - {"odd"} == {"bowl", "cup"}


@pytest.mark.parametrize(
    ("kind", "found"), [("together", {"cup", "bowl", "keys"}), ("near", {"cup", "bowl"})]
)
def test_the_paper_unites_what_is_together(home: Home, kind: RelationKind, found: set[str]) -> None:
    asked = FormalQuery("?", "Q2", "when", (ObjectTerm("bowl"), CUP), Relation(kind))
    home.seen("cup", 20, 25, at=(1, 1, 1))
    if kind == "together":
        asked = replace(asked, objects=(*asked.objects, KEY))
    answer = run(home, asked, parameters=PAPER)
    assert ids(answer) == found
    if kind == "together":
        assert answer.unjudged == ("with the cup and the key",)
        assert all(keyframe.group is None for keyframe in answer.keyframes)


def test_a_rare_word_for_a_thing_finds_it_lower(home: Home) -> None:
    home.thing("phone", "cell phone", votes=(("cell phone", 12.0), ("glasses", 8.0)))
    home.seen("phone", 40, 45, at=(2, 2, 1))
    home.thing("book", "book", votes=(("book", 19.0), ("glasses", 1.0)))
    home.seen("book", 40, 45, at=(2, 2, 1))
    asked = FormalQuery("?", "Q1", "whether", (ObjectTerm("glasses"),))
    answer = run(home, asked)
    assert ids(answer) == {"phone"}
    assert answer.keyframes[0].why["votes"] == 0.4
    assert answer.keyframes[0].score < 0.5
    for counted in (replace(asked, ask="count"), asked):
        forced: Precision | None = None if counted.ask == "count" else "category"
        assert run(home, counted, precision=forced).status != "found"


def test_precision_attribute_scores_colours_and_nothing_else(home: Home) -> None:
    home.thing("mug", "mug", paint="red")
    home.seen("mug", 40, 45, at=(2, 2, 1))
    red = FormalQuery("?", "Q1", "whether", (replace(CUP, attributes=("blue",)),))
    assert ids(run(home, red, precision="category")) == {"cup", "mug"}
    assert run(home, red, precision="attribute").status == "not_found"
    assert len(ids(run(home, red, precision="any"))) > 2


def landmark_of(home: Home, asked: FormalQuery) -> str | None:
    return run(home, asked).keyframes[0].near


def where(category: str) -> FormalQuery:
    return FormalQuery("?", "Q3", "where", (ObjectTerm(category),), select="last")


def chair(home: Home, box: Box = UNDER) -> None:
    home.thing("chair", "chair", extent_m=(0.5, 0.9))
    home.seen("chair", 0, 200, at=(1.1, 1, 0.5), times=50, box=box)


def test_a_landmark_is_large_and_stays(home: Home) -> None:
    chair(home)
    home.thing("bin", "bin", extent_m=(0.3, 0.3))
    home.seen("bin", 0, 200, at=(1.1, 1, 0.5), times=50)
    assert landmark_of(home, where("cup")) == "table"


def test_a_landmark_is_confirmed(home: Home) -> None:
    home.thing("desk", "desk", extent_m=(1.2, 0.7))
    home.seen("desk", 0, 1, at=(1.05, 1, 0.9), times=2)
    home.thing("shelf", "shelf", votes=(("shelf", 5.0), ("book", 4.0)))
    home.seen("shelf", 0, 1, at=(1.05, 1, 0.9), times=50)
    home.thing("bed", "bed", tentative=True)
    home.seen("bed", 0, 1, at=(1.05, 1, 0.9), times=50)
    home.thing("toy desk", "desk", extent_m=(0.2, 0.1))
    home.seen("toy desk", 0, 1, at=(1.05, 1, 0.9), times=50)
    assert landmark_of(home, where("cup")) == "table"


def test_a_landmark_is_not_moved_about(home: Home) -> None:
    home.thing("desk", "desk")
    home.seen("desk", 0, 10, at=(1.05, 1, 0.9), times=10)
    home.seen("desk", 100, 110, at=(8, 2, 0.9), times=10, place=1)
    home.thing("couch", "couch")
    home.seen("couch", 0, 10, at=(1.05, 1, 0.9), times=10, absent=100)
    assert landmark_of(home, where("cup")) == "table"


def test_a_large_thing_that_stays_is_a_landmark_whatever_its_name(home: Home) -> None:
    home.thing("loom", "loom", extent_m=(1.6, 1.2))
    home.seen("loom", 0, 200, at=(1.0, 1.1, 0.9), times=50)
    assert landmark_of(home, where("cup")) == "loom"


def test_a_thing_is_never_told_by_itself_or_its_kind(home: Home) -> None:
    home.thing("table-2", "table")
    home.seen("table-2", 0, 300, at=(1.4, 1, 0.7), times=50)
    assert landmark_of(home, where("table")) is None
    cups = FormalQuery("?", "Q1", "what", (THING,))
    near = {k.object_id: k.near for k in run(home, cups).keyframes}
    assert near["table-2"] is None
    assert near["cup"] == "table"


def test_far_from_everything_a_distance_tells_the_place(home: Home) -> None:
    home.thing("ball", "ball")
    home.seen("ball", 0, 10, at=(1.0, 4.0, 0.7))
    keyframe = run(home, where("ball")).keyframes[0]
    assert keyframe.near is None
    assert keyframe.beyond == ("table", 3.0)


def test_what_a_frame_showed_through_a_door_is_not_together_now(home: Home) -> None:
    home.thing("vase", "vase")
    home.seen("vase", 10, 15, at=(7, 2, 1))
    home.met("cup", "vase", 10, 15)
    together = FormalQuery(
        "?", "Q2", "whether", (CUP, ObjectTerm("vase")), Relation("together"), select="all"
    )
    assert run(home, together).status == "found"  # one frame showed both
    now = run(home, replace(together, select="last"))
    assert (now.status, now.reason) == ("not_found", "gone")
    assert now.otherwise is not None
    assert now.otherwise.place == "kitchen"
