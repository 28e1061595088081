"""Readings that were once taken for something else, each by the rule that reads it now."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime

import pytest

from grammar import (
    Ambiguous,
    FormalQuery,
    NotUnderstood,
    ObjectTerm,
    OutOfScope,
    QuestionError,
    Relation,
    parse,
)

NOW = datetime.fromisoformat("2026-05-14T20:30:00+01:00")


def read(text: str) -> FormalQuery:
    return parse(text, now=NOW)


@pytest.mark.parametrize(
    "text", ["did you see the cup but not the bowl", "did you see the cup and not the bowl"]
)
def test_one_thing_without_another_is_two_questions(text: str) -> None:
    with pytest.raises(QuestionError):
        read(text)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("did you see the cup twice yesterday", "how often"),
        ("were all cups in the kitchen", "so of all"),
        ("is every cup on the table", "so of all"),
        ("did you see a cup and a book but no bowl", "on or with what"),
        ("where was the cup before the coffee table", "by the clock"),
        ("where was the cup before it was on the table", "by the clock"),
    ],
)
def test_what_no_sighting_tells_is_refused_with_what_does(text: str, told: str) -> None:
    with pytest.raises(OutOfScope) as caught:
        read(text)
    assert told in str(caught.value)


@pytest.mark.parametrize(
    "text",
    [
        "was nobody's cup on the table",
        "did you see a table with nothing on it",
        "did you see a cup that is not a mug",
        "did you see nothing but cups on the table",
        "did you see neither the cup nor the bowl",
    ],
)
def test_what_the_algebra_does_not_say_is_refused(text: str) -> None:
    with pytest.raises(QuestionError):
        read(text)


@pytest.mark.parametrize(
    ("text", "offered"),
    [
        (
            "Did you see the cup yesterday but not today?",
            ("Did you see the cup yesterday?", "Did you see the cup today?"),
        ),
        (
            "did you see a bottle at 9:30 but not at 11",
            ("did you see a bottle at 9:30", "did you see a bottle at 11"),
        ),
    ],
)
def test_a_time_when_and_one_when_not_are_offered_each(text: str, offered: tuple[str, ...]) -> None:
    with pytest.raises(NotUnderstood) as caught:
        read(text)
    assert caught.value.suggestions == offered


@pytest.mark.parametrize(
    ("text", "formal"),
    [
        (
            "show me red or blue cups without handles",
            "red(x), cup(y), not handle(y), blue(yo1), cup(yo1), not handle(yo1), or(y, yo1) "
            "| OIc.find(x, y) | ask what",
        ),
        (
            "did you see a red or blue cup and a bowl",
            "red(x), cup(y), blue(yo1), cup(yo1), or(y, yo1), bowl(z) "
            "| OIc.find(x, y), OIc.find(z)",
        ),
        (
            "is there something red or blue under the bed",
            'red(x), object(y), said(y, "something"), blue(yo1), object(yo1), '
            'said(yo1, "something"), or(y, yo1), bed(z) '
            "| STc.find(OIc.find(x, y), OIc.find(z), under) | ask whether, now",
        ),
        (
            "where else was the cup besides the kitchen",
            "cup(x) | STc.find(OIc.find(x), not in kitchen)",
        ),
        (
            "where was the cup other than in the kitchen",
            "cup(x) | STc.find(OIc.find(x), not in kitchen)",
        ),
        (
            "is neither of the cups on the table",
            "cup(x), table(y) | STc.find(OIc.find(x), OIc.find(y), on) | ask whether, negated, now",
        ),
        (
            "has the cup ever not been on the table",
            "cup(x), table(y) | STc.find(OIc.find(x), OIc.find(y), on) "
            "| ask whether, negated, contrary",
        ),
        (
            "did you not see the cup on the table",
            "cup(x), table(y) | STc.find(OIc.find(x), OIc.find(y), on) | ask whether, negated",
        ),
        (
            "what did you see besides the cup",
            'object(x), said(x, "thing"), cup(xn1), other(x, xn1) | OIc.find(x) | ask what',
        ),
        (
            "when were the cup and the bowl in the kitchen together",
            "cup(x), bowl(y) | STc.find(OIc.find(x), OIc.find(y), together, in kitchen)",
        ),
    ],
)
def test_two_constructions_in_one_are_read_together(text: str, formal: str) -> None:
    query = read(text)
    assert query.formal == formal


def test_what_else_lies_there_leaves_one_out() -> None:
    (thing, _) = read("what is on the table but not the cup").objects
    assert thing.other_than == (ObjectTerm("cup"),)
    assert thing.to_json()["without"] == ["cup"]


@pytest.mark.parametrize(
    ("text", "word", "quantity"),
    [
        ("where is the five minute timer", "five minute timer", None),
        ("where is the 5 liter bottle", "5 liter bottle", None),
        ("where are the two cups", "cup", 2),
        ("did you see two wine glasses", "wine glass", 2),
    ],
)
def test_a_number_counts_many_and_measures_one(text: str, word: str, quantity: int | None) -> None:
    (term,) = read(text).objects
    assert (term.word, term.quantity) == (word, quantity)


@pytest.mark.parametrize(
    ("text", "word", "owner", "place"),
    [
        ("where are my keys kitchen", "key", "me", "kitchen"),
        ("remote control last night kitchen", "remote control", None, "kitchen"),
        ("where is the kitchen table", "kitchen table", None, None),
        ("where are anna s keys", "key", "anna", None),
        ("where are my sister anna's pills", "pill", "anna", None),
        ("where is the t v remote", "tv remote", None, None),
        ("where is the a4 paper", "a4 paper", None, None),
    ],
)
def test_words_that_a_recogniser_parts_or_runs_together(
    text: str, word: str, owner: str | None, place: str | None
) -> None:
    query = read(text)
    assert [(t.word, t.owner) for t in query.objects] == [(word, owner)]
    assert query.place == place


@pytest.mark.parametrize(
    ("text", "without"),
    [
        ("where is the jar that isn't chipped", ("chipped",)),
        ("where is the jar that was left on the shelf", ()),
    ],
)
def test_what_became_of_a_thing_is_told_of_it_unless_it_is_where(
    text: str, without: tuple[str, ...]
) -> None:
    assert read(text).objects[0].without == without


@pytest.mark.parametrize(
    ("text", "attributes"),
    [
        ("where is a bowl made of glass", ("glass",)),
        ("something made of glass yesterday", ("glass",)),
        ("something round and made of metal", ("round", "metal")),
    ],
)
def test_a_material_after_made_of_is_no_noun(text: str, attributes: tuple[str, ...]) -> None:
    assert [t.attributes for t in read(text).objects] == [attributes]


@pytest.mark.parametrize(
    ("text", "select"),
    [
        ("how long ago did you see my keys", "last"),
        ("how long ago did you first see my keys", "first"),
        ("what's the first time you saw the bowl on the counter", "first"),
    ],
)
def test_how_long_ago_is_of_the_last_time(text: str, select: str) -> None:
    query = read(text)
    assert (query.ask, query.select) == ("when", select)


@pytest.mark.parametrize(
    ("text", "offered"),
    [
        ("is the milk cold", "Where is the milk?"),
        ("is the soup cold", "Where is the soup?"),
        ("where was the cup tomorrow", "Where is the cup?"),
        ("is the soup cold yesterday", "Where was the soup yesterday?"),
        ("were the keys open between 3 and 4 pm", "Where were the keys between 3 and 4 pm?"),
        ("what color is my bag", "Where is my bag?"),
    ],
)
def test_a_state_or_a_future_is_refused_with_what_may_be_asked_of_the_thing(
    text: str, offered: str
) -> None:
    with pytest.raises(QuestionError) as caught:
        read(text)
    assert caught.value.suggestions[0] == offered


@pytest.mark.parametrize(
    ("text", "owner"),
    [
        ("where did my wife leave the keys", None),
        ("where did my wife leave her keys", "wife"),
        ("where did dad put his keys", "dad"),
        ("did the kids leave their keys in the hall", "kid"),
        ("where did he put his keys", None),
        ("where did dad put my keys", "me"),
    ],
)
def test_who_did_it_owns_what_is_his(text: str, owner: str | None) -> None:
    assert [(t.word, t.owner) for t in read(text).objects] == [("key", owner)]


@pytest.mark.parametrize(
    "text",
    [
        "where were my keys that day",
        "where were my keys later that week",
        "where were my keys later",
        "where were my keys on my birthday",
        "where were my keys before i went out",
        "before i left it",
    ],
)
def test_a_time_told_by_what_happened_is_never_left_out(text: str) -> None:
    with pytest.raises(QuestionError):
        read(text)


def test_what_one_wants_to_do_next_is_no_time() -> None:
    assert read("where are my keys before i go out").time is None


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("where was the cup at 25:00", "no day has such an hour or minute"),
        ("where was the cup at 8 pm PST", "say it without a zone"),
        ("where was the cup at noon eastern standard time", "say it without a zone"),
    ],
)
def test_a_time_that_the_home_has_not_is_refused_with_the_reason(text: str, why: str) -> None:
    with pytest.raises(NotUnderstood) as caught:
        read(text)
    assert why in caught.value.reason


@pytest.mark.parametrize(
    ("text", "quantity"),
    [
        ("are there at least two cups on the table", 2),
        ("did you see more than three cups", 4),
        ("did you see no fewer than three cups", 3),
        ("did you see at least one cup", None),
    ],
)
def test_the_least_number_that_must_be_there(text: str, quantity: int | None) -> None:
    assert read(text).objects[0].quantity == quantity


@pytest.mark.parametrize(
    ("text", "quantity", "bound"),
    [
        ("did you see two cups", 2, "least"),
        ("did you see two or more cups", 2, "least"),
        ("did you see two cups or more in the kitchen", 2, "least"),
        ("did you see two cups at least", 2, "least"),
        ("are there no fewer than three cups", 3, "least"),
        ("did you see fewer than three cups", 2, "most"),
        ("did you see less than two cups", 1, "most"),
        ("are there at most two cups on the table", 2, "most"),
        ("were there no more than 5 cups in the sink yesterday", 5, "most"),
        ("are there not more than two cups in the hall", 2, "most"),
        ("did you see up to three cups", 3, "most"),
        ("did you see a maximum of three cups", 3, "most"),
        ("did you see two or fewer red cups", 2, "most"),
        ("did you see two cups at most", 2, "most"),
        ("did you see exactly four cups?", 4, "exactly"),
        ("did you see four cups exactly", 4, "exactly"),
        ("did you see only one red cup", 1, "exactly"),
        ("did you only see two cups yesterday", 2, "exactly"),
        ("is there just one chair in the hall", 1, "exactly"),
        ("was the bowl near precisely two cups", None, "least"),
    ],
)
def test_how_a_number_is_meant(text: str, quantity: int | None, bound: str) -> None:
    term = read(text).objects[0]
    assert (term.quantity, term.bound) == (quantity, bound)


def test_exactly_without_a_number_says_nothing() -> None:
    assert read("where is the cup exactly") == replace(
        read("where is the cup"), text="where is the cup exactly"
    )


def test_less_than_a_time_ago_is_no_number_of_things() -> None:
    assert read("did you see the cup less than two hours ago").time is not None


@pytest.mark.parametrize(
    ("text", "kind", "negated"),
    [
        ("where is the cup on the table and near the lamp", "near", False),
        ("is the cup on the table and behind the lamp", "behind", False),
        ("is the cup on the table and not near the lamp", "near", True),
        ("is the cup on the table but not near the lamp", "near", True),
        ("where did you see the cup on the table not near the lamp", "near", True),
        ("is the cup on the table, not near the lamp", "near", True),
    ],
)
def test_and_says_more_of_what_is_asked_for(text: str, kind: str, negated: bool) -> None:
    query = read(text)
    cup, table = query.objects
    assert (cup.category, table.category, table.where) == ("cup", "table", None)
    assert query.relation == Relation("on")
    assert cup.where is not None
    assert (cup.where.kind, cup.where.negated, cup.where.object.word) == (kind, negated, "lamp")
    assert not query.negated


@pytest.mark.parametrize("joined", [" but not", " and not", ", not", " not"])
def test_what_is_denied_after_a_room_is_a_relation(joined: str) -> None:
    query = read(f"when was the cup in the kitchen{joined} on the table")
    assert (query.place, query.relation) == ("kitchen", Relation("on", negated=True))
    assert not query.negated


def test_without_and_the_second_place_tells_the_first_one() -> None:
    _, table = read("where is the cup on the table near the lamp").objects
    assert table.where is not None
    assert table.where.object.word == "lamp"


@pytest.mark.parametrize(
    ("text", "offered"),
    [
        (
            "is there a cup on the desk and the nightstand",
            ("is there a cup on the desk", "is there a cup on the nightstand"),
        ),
        ("what was in the box and in the bag", ("what was in the box", "what was in the bag")),
        (
            "how many cups are on the desk, the shelf and the table",
            (
                "how many cups are on the desk",
                "how many cups are on the shelf",
                "how many cups are on the table",
            ),
        ),
    ],
)
def test_what_lies_on_one_and_on_another_is_asked_one_at_a_time(
    text: str, offered: tuple[str, ...]
) -> None:
    with pytest.raises(Ambiguous) as caught:
        read(text)
    assert caught.value.suggestions == offered


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("Was the wallet always in the hall?", "always"),
        ("what is always on the table", "always"),
        ("Was the cup only in the kitchen?", "only"),
        ("Were there only cups on the table?", "only"),
        ("did you only see the cup in the kitchen", "only"),
        ("were the keys in the hall only", "only"),
        ("Were the cup and the bowl in the same room?", "in the same room"),
        ("what was in the same room as the cup", "in the same room"),
    ],
)
def test_what_no_sighting_tells_is_refused_at_its_word(text: str, word: str) -> None:
    with pytest.raises(OutOfScope) as caught:
        read(text)
    assert text[caught.value.position :].startswith(word)
    assert "I could not follow" not in str(caught.value)


@pytest.mark.parametrize(
    "text",
    [
        "where are my keys always",
        "where is the cup that i always use",
        "is the only cup in the kitchen",
        "i only want to know if the cup is in the kitchen",
    ],
)
def test_always_and_only_that_limit_no_sighting_say_nothing(text: str) -> None:
    plain = text.replace(" that i always use", "").replace(" always", "").replace("only ", "")
    assert replace(read(text), text="") == replace(read(plain), text="")


@pytest.mark.parametrize(
    "text",
    [
        "did you see a cup and a bowl on the coffee table",
        "when were the cup and the bowl on the coffee table",
        "were the cup and the bowl on the coffee table together",
        "were the cup and the bowl on the coffee table at the same time",
    ],
)
def test_two_things_on_one_are_together_and_each_is_on_it(text: str) -> None:
    query = read(text)
    assert query.relation == Relation("together")
    assert [(t.word, t.where and (t.where.kind, t.where.object.word)) for t in query.objects] == [
        ("cup", ("on", "coffee table")),
        ("bowl", ("on", "coffee table")),
    ]


@pytest.mark.parametrize(
    "text",
    [
        "is the cup on the table and the bowl on the chair",
        "are the cup and the bowl on the table and near the lamp",
        "where is the cup on the table between the sofa and the window",
    ],
)
def test_what_one_query_cannot_hold_is_refused(text: str) -> None:
    with pytest.raises(QuestionError):
        read(text)


@pytest.mark.parametrize(
    ("text", "day"),
    [
        ("I left my jacket somewhere yesterday, where was it?", 13),
        ("I left my jacket somewhere yesterday. Where was it last seen?", None),
        ("I left my jacket somewhere yesterday, where is it?", None),
        ("I left my jacket somewhere yesterday. Where was it on monday?", 11),
    ],
)
def test_the_time_told_before_is_of_where_it_was(text: str, day: int | None) -> None:
    query = read(text)
    assert [(t.word, t.owner) for t in query.objects] == [("jacket", "me")]
    start = query.time.start if query.time is not None else None
    assert (start.day if start is not None else None) == day


@pytest.mark.parametrize(
    "text", ["when was the bottle without the cup", "was the bottle ever seen without a cup"]
)
def test_a_thing_without_another_is_not_together_with_it(text: str) -> None:
    query = read(text)
    assert [t.word for t in query.objects] == ["bottle", "cup"]
    assert query.relation == Relation("together", negated=True)
    assert not query.negated


def test_a_thing_without_a_part_lacks_it() -> None:
    assert read("where is the bottle without a label").objects[0].without == ("label",)


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("show me all pictures of my keys", "key"),
        ("do you have a photo of my keys", "key"),
        ("where is the picture of my mother", "picture"),
    ],
)
def test_a_picture_that_the_memory_shows_is_no_thing_of_the_home(text: str, word: str) -> None:
    assert read(text).objects[0].word == word


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("list all sightings of the forklift from the past 3 hours", ["forklift"]),
        ("retrieve all observations of the yellow cone", ["cone"]),
        ("where is the camera", ["camera"]),
        ("was the laptop with the camera", ["laptop", "camera"]),
        ("was the camera seen on the desk", ["camera", "desk"]),
        ("did the camera see my keys", ["key"]),
        ("what has the camera seen", ["thing"]),
        ("when did your camera last see my keys", ["key"]),
    ],
)
def test_the_camera_is_a_thing_where_it_sees_nothing(text: str, words: list[str]) -> None:
    assert [t.word for t in read(text).objects] == words


@pytest.mark.parametrize(
    ("text", "ask", "select"),
    [
        ("all the places where i left my keys", "where", "all"),
        ("list every place you saw my keys", "where", "all"),
        ("list all the times you saw my keys", "when", "all"),
        ("every time you saw my keys", "when", "all"),
        ("when did you see my keys the very first time", "when", "first"),
        ("where were my keys the first time you saw them", "where", "first"),
        ("where did you saw last time my keys", "where", "last"),
        ("last time you saw my keys", "when", "last"),
        ("when was the first time that you noticed my keys", "when", "first"),
        ("what was the latest spot my keys were seen", "where", "last"),
        ("tell me the most recent place where you saw my keys", "where", "last"),
        ("where are they my keys", "where", "last"),
        ("my keys, where'd I leave 'em?", "where", "last"),
        ("would it be possible to know where my keys are", "where", "last"),
        ("have you seen somewhere my keys", "whether", "all"),
        ("at least how many of my keys did you see", "count", "all"),
        ("how much keys of mine did you see", "count", "all"),
        ("would you be so kind as to tell me where my keys are", "where", "last"),
        ("would it be possible for you to list all places i left my keys", "where", "all"),
    ],
)
def test_which_of_its_sightings_are_asked_for(text: str, ask: str, select: str) -> None:
    query = read(text)
    assert [(t.word, t.owner) for t in query.objects] == [("key", "me")]
    assert (query.ask, query.select) == (ask, select)


@pytest.mark.parametrize(
    ("text", "owner"),
    [
        ("where is Mrs Hall's walking stick", "mrs hall"),
        ("did you see Anna Smith's walking stick", "anna smith"),
        ("where is the office manager's walking stick", "office manager"),
        ("where is aunt mary's walking stick", "mary"),
        ("where did the kids leave dad's walking stick", "dad"),
        ("where did grandad leave his walking stick", "grandad"),
        ("where is Tomas' walking stick", "tomas"),
        ("where is the boss's walking stick", "boss"),
        ("where is the kids' walking stick", "kid"),
    ],
)
def test_an_owner_may_have_several_words(text: str, owner: str) -> None:
    assert [(t.word, t.owner) for t in read(text).objects] == [("walking stick", owner)]


@pytest.mark.parametrize(
    ("text", "attributes", "without"),
    [
        ("where is the box, the cardboard one", ("cardboard",), ()),
        ("where is the box the cardboard one not the wooden one", ("cardboard",), ("wooden",)),
        ("where is the box, the light blue one?", ("light blue",), ()),
        ("did you see the box the big striped one yesterday", ("big", "striped"), ()),
        ("where is the object box", (), ()),
        ("show me the red item box", ("red",), ()),
    ],
)
def test_which_one_may_be_said_after_its_kind(
    text: str, attributes: tuple[str, ...], without: tuple[str, ...]
) -> None:
    (term,) = read(text).objects
    assert (term.category, term.attributes, term.without) == ("box", attributes, without)


@pytest.mark.parametrize(
    ("text", "owners"),
    [
        ("where are anna's shoes and bag", ["anna", "anna"]),
        ("where are my red shoes and blue bag", ["me", "me"]),
        ("where are my shoes and the bag", ["me", None]),
        ("where are the shoes and my bag", [None, "me"]),
        ("did you see my shoes, hat and bag", ["me", "me", "me"]),
    ],
)
def test_an_owner_is_of_all_that_bare_and_joins(text: str, owners: list[str | None]) -> None:
    assert [t.owner for t in read(text).objects] == owners


@pytest.mark.parametrize(
    ("text", "negated"),
    [("nobody saw the cup, right?", True), ("there was a cup, wasn't there?", False)],
)
def test_a_statement_with_a_tag_asks_whether(text: str, negated: bool) -> None:
    query = read(text)
    assert (query.ask, query.negated) == ("whether", negated)


def test_what_is_stuck_to_a_thing_is_on_it() -> None:
    assert read("what is stuck to the fridge").relation == Relation("on")


@pytest.mark.parametrize(
    ("text", "attributes"),
    [
        ("where is the orange orange", ("orange",)),
        ("where is the the orange", ()),
        ("where is the orange orange orange", ("orange",)),
    ],
)
def test_a_look_and_its_thing_may_be_one_word(text: str, attributes: tuple[str, ...]) -> None:
    (term,) = read(text).objects
    assert (term.category, term.attributes) == ("orange", attributes)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("where is my number two pencil", ["number two pencil"]),
        ("what is on shelf 2", ["thing", "shelf 2"]),
        ("what was in box three yesterday", ["thing", "box three"]),
        ("is my iphone 12 case in drawer 4", ["iphone 12 case", "drawer 4"]),
    ],
)
def test_a_number_after_a_noun_names_one_of_its_kind(text: str, words: list[str]) -> None:
    assert [t.word for t in read(text).objects] == words


@pytest.mark.parametrize("text", ["where was the cup 3", "did you see the cup 3 times"])
def test_a_number_that_may_be_a_time_is_not_part_of_a_noun(text: str) -> None:
    with pytest.raises(QuestionError):
        read(text)


def test_compared_to_a_time_is_since_then() -> None:
    query = read("what is different on the shelf compared to yesterday")
    assert query.ask == "moved"
    assert query.time is not None
    assert f"{query.time.start:%m-%d}" == "05-13"
    assert query.time.end is None


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("did daddy's hat go on the chair", ["hat", "chair"]),
        ("daddy's hat is it still on the chair", ["hat", "chair"]),
        ("which of the hats on the chair are not white", ["hat", "chair"]),
    ],
)
def test_what_is_where(text: str, words: list[str]) -> None:
    query = read(text)
    assert [t.word for t in query.objects] == words
    assert query.relation == Relation("on")
    assert not query.negated


def test_which_are_not_white_denies_it_of_what_is_asked_for() -> None:
    hat, chair = read("which of the hats on the chair are not white").objects
    assert (hat.without, chair.without) == (("white",), ())


def test_how_much_of_a_look_says_nothing() -> None:
    assert read("where is the very big quite old cup").objects[0].attributes == ("big", "old")


def test_a_floor_with_a_number_is_a_place() -> None:
    assert read("what is on the second floor").place == "second floor"
    assert read("what is on the floor").place is None


def test_a_chance_asks_whether() -> None:
    query = read("any chance you spotted my black wallet this morning")
    assert (query.ask, query.objects[0].word) == ("whether", "wallet")


@pytest.mark.parametrize("look", ["color", "colour", "size", "material"])
def test_a_look_is_not_told_but_looked_for(look: str) -> None:
    text = f"what {look} is my bag"
    with pytest.raises(QuestionError) as caught:
        read(text)
    assert caught.value.kind == "out_of_scope"
    assert caught.value.position == text.index(look)
    assert f"I do not tell the {look} of a thing" in caught.value.reason


@pytest.mark.parametrize(
    ("text", "ask"), [("When did you not see the bowl?", "when"), ("what has not moved", "moved")]
)
def test_what_was_not_so_is_read_as_said(text: str, ask: str) -> None:
    query = read(text)
    assert (query.ask, query.negated, query.relation) == (ask, True, None)


@pytest.mark.parametrize(
    ("text", "looks"),
    [
        ("where are the red and pink cups", [("red",), ("pink",)]),
        ("are my red and blue cups in the kitchen", [("red",), ("blue",)]),
        ("where is the red and pink cup", [("red", "pink")]),
        ("did you see red and pink cups", [("red", "pink")]),
        ("where are the black and white cups", [("black", "white")]),
        ("where are the red and white socks", [("red", "white")]),
        ("where are the red and black scissors", [("red", "black")]),
    ],
)
def test_two_looks_of_the_things_are_of_each(text: str, looks: list[tuple[str, ...]]) -> None:
    assert [term.attributes for term in read(text).objects] == looks
