"""A question in, an answer out: grammar, plan, store, sentence. One engine for chat, ask, batch."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from datetime import datetime
from time import perf_counter
from typing import Literal, cast, get_args
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

from assistant.agreeing import agreed
from assistant.all_of_them import some_of_them_words, wherever_they_are
from assistant.beside import where_it_is
from assistant.either import one_or_another, told_of_either
from assistant.explanation import Explanation
from assistant.forgotten_words import but_forgotten
from assistant.left_behind import as_left_behind
from assistant.lexicon import VocabularyLexicon
from assistant.newest_frame import newest_frame
from assistant.not_begun import not_begun_words
from assistant.numbers_together import so_many_and_more, told_of_so_many
from assistant.own_words import as_heard
from assistant.passed_over import of_its_clause, of_its_number
from assistant.polarity import expecting
from assistant.reply import sentence
from assistant.rooms import EVERYTHING, everything_words, in_each_room, told_by_room
from assistant.several import one_by_one, told_of_each
from assistant.spots import of_the_spot, on_a_spot, told_as_place, without_itself
from assistant.telling_apart import with_colours
from assistant.tense import gone_by_now, is_no_more, planned
from assistant.untaught import doubt_words, doubted, plan_of_the_unnamed
from assistant.whose import whose_words
from d3a.answer import Answer, Status
from d3a.answering.conclude import within
from d3a.answering.facts import Facts
from d3a.answering.points import asks_where_all_is
from d3a.execute import execute
from d3a.model import BadInput
from d3a.parameters import Parameters
from d3a.plan import Plan, Precision
from d3a.store.base import FORGOTTEN, NativeQuery, Store, StoreError
from grammar import StoreWords, parse
from grammar.errors import NotUnderstood, OutOfScope, QuestionError
from grammar.forms import FormalQuery, FormError
from grammar.notation import looks_formal, read

TOLD_FROM = 50
"""The sentence is told from so many keyframes, however few of them are shown."""
PRECISIONS: tuple[Precision, ...] = get_args(Precision)


def store_words(store: Store, facts: Facts | None = None) -> StoreWords:
    """Return the words that the grammar is to know of this store: categories, names, places.

    A detector's class list counts too: "never seen" and "no such word" are different answers.
    facts: what was read of the store for this question already. Raises StoreError.
    """
    facts = facts or Facts(store)
    return StoreWords(
        categories=tuple(dict.fromkeys([*facts.categories(), *(facts.classes() or ())])),
        names=tuple((name.word, name.owner) for name in facts.names()),
        places=tuple(region.name for region in facts.regions()),
    )


def home_zone(store: Store) -> ZoneInfo | None:
    """Return the home's IANA zone as the store has it, None where it has none.

    Raises StoreError; a zone that the time zone database does not know counts as none.
    """
    name = store.meta("zone")
    if name is None:
        return None
    try:
        return ZoneInfo(str(name))
    except (ZoneInfoNotFoundError, ValueError):
        return None


def store_now(
    store: Store, given: datetime | Literal["last"] | None, clock: Callable[[], datetime]
) -> datetime:
    """Return the `now` of a question, in the home's zone.

    given: a time, or "last" for the newest frame of the store. Else the store's own fixed `now`
    (a demo home has one), else `clock()`, both no earlier than the newest frame. A time without an
    offset is the home's wall clock. An answer goes by what was seen until its `now`, so a time that
    is given hides what was seen since; a clock behind that of the robot hides nothing. Raises
    StoreError.
    """
    zone = home_zone(store)
    if isinstance(given, datetime):
        moment = given
    else:
        fixed = store.meta("now")
        moment = clock() if fixed is None else datetime.fromisoformat(str(fixed))
    if moment.tzinfo is None:
        moment = moment.replace(tzinfo=zone or ZoneInfo("UTC"))
    moment = moment if zone is None else moment.astimezone(zone)
    if isinstance(given, datetime):
        return moment
    newest = newest_frame(store, moment)
    return newest if given == "last" else max(moment, newest)


def ask(
    store: Store,
    text: str,
    *,
    now: datetime,
    limit: int = 50,
    precision: str | None = None,
    id: str | None = None,  # noqa: A002  the contract's own name
) -> Answer:
    """Answer a question, in words or in the formal notation.

    now: aware, in the home's zone; see `store_now`. precision: one of
    `d3a.answering.steps.Precision`, forces a rung of the matching ladder. A question that
    cannot be answered and a store that fails are answers with their status, never an exception.
    """
    started = perf_counter()
    try:
        facts = Facts(store).as_of(now)
        query = read_question(store, text, now=now, facts=facts)
    except QuestionError as error:
        return replace(refusal(error), id=id, elapsed_ms={"total": _ms_since(started)})
    except StoreError as error:
        return replace(failure(text, error), id=id, elapsed_ms={"total": _ms_since(started)})
    parse_ms = _ms_since(started)
    answer = ask_query(store, query, now=now, limit=limit, precision=precision, facts=facts)
    elapsed = {"parse": parse_ms} | answer.elapsed_ms | {"total": _ms_since(started)}
    return replace(answer, id=id, elapsed_ms=elapsed)


def read_question(
    store: Store, text: str, *, now: datetime, facts: Facts | None = None
) -> FormalQuery:
    """Return the formal query of a question in words, in notation or as its JSON record.

    Raises QuestionError where it has none, StoreError where the store's words cannot be had.
    """
    if text.lstrip().startswith("{"):
        return _of_record(text)
    if looks_formal(text):
        return read(text, now=now)
    return parse(text, now=now, words=store_words(store, facts))


def _of_record(text: str) -> FormalQuery:
    """Return the formal query of its record as JSON text."""
    try:
        return FormalQuery.from_json(json.loads(text))
    except json.JSONDecodeError as error:
        raise NotUnderstood(text, error.pos, f"The record breaks off: {error.msg}.") from error
    except FormError as error:
        raise NotUnderstood(text, 0, f"The record makes no query: {error}.") from error


def ask_query(
    store: Store,
    query: FormalQuery,
    *,
    now: datetime,
    limit: int = 50,
    precision: str | None = None,
    facts: Facts | None = None,
) -> Answer:
    """Answer a formal query, as `ask` does; dialogues and tests come in here.

    facts: what was read of the store for this question already.
    """
    started = perf_counter()
    rung = _precision(precision)
    if _asks_for_the_unseen(query):
        told = "That asks for what was not seen, and I remember what was. Ask when it was seen."
        return replace(refusal(OutOfScope(query.text, 0, told)), query=query)
    try:
        facts = (facts or Facts(store)).as_of(now)
        query = on_a_spot(query, facts)
        answer = _told(store, query, facts, now, max(limit, _told_from(query)), rung)
    except StoreError as error:
        return replace(failure(query.text, error), query=query)
    answer = within(answer, limit)
    return replace(answer, elapsed_ms=answer.elapsed_ms | {"total": _ms_since(started)})


def _told(
    store: Store,
    query: FormalQuery,
    facts: Facts,
    now: datetime,
    limit: int,
    rung: Precision | None,
) -> Answer:
    """Return the answer of a formal query with its sentence, by room or by thing where asked so."""
    if rooms := in_each_room(query, facts.regions()):
        each = [_answered(store, room, facts, now, limit, rung) for room in rooms]
        return told_by_room(query, each)
    if plain := expecting(query):
        return replace(_told(store, plain, facts, now, limit, rung), query=query)
    if things := one_by_one(query):
        return told_of_each(query, [_told(store, one, facts, now, limit, rung) for one in things])
    if bounds := so_many_and_more(query):
        many, more = (_told(store, one, facts, now, limit, rung) for one in bounds)
        return told_of_so_many(query, many, more)
    answer = _answered(store, query, facts, now, limit, rung)
    answer = as_left_behind(answer, query, facts, VocabularyLexicon())
    if answer.status == "found" and is_no_more(answer, query):
        answer = gone_by_now(answer)
    if where := where_it_is(answer, query):
        its = _answered(store, where, facts, now, limit, rung)
        if its.status != "found" or its.keyframes[0].last_absent is not None:
            return replace(answer, answer=_said(its, where, facts, now).answer)
        answer = replace(answer, otherwise=its.keyframes[0])
    other = _of_the_unnamed(store, answer, query, facts, now, limit, rung)
    told = _said(answer if other is None else doubted(answer, other), query, facts, now)
    if other is not None:
        told = replace(told, answer=doubt_words(answer, other, told.answer, now))
    if answer.status != "found":
        return told
    if either := one_or_another(query):
        each = [_told(store, one, facts, now, limit, rung) for one in either]
        return told_of_either(query, told, each)
    asked = answer.query or query  # by its tense
    if all_of_them := wherever_they_are(asked):
        whole = _answered(store, all_of_them, facts, now, limit, rung)
        return replace(told, answer=some_of_them_words(answer, whole, asked, now) or told.answer)
    return agreed(told, facts)


def _told_from(query: FormalQuery) -> int:
    """Return from how many keyframes the sentence is told, however few of them are shown."""
    return EVERYTHING if asks_where_all_is(query) else TOLD_FROM


def _answered(
    store: Store,
    query: FormalQuery,
    facts: Facts,
    now: datetime,
    limit: int,
    rung: Precision | None,
) -> Answer:
    """Return the answer of a formal query without its sentence."""
    made = planned(query, facts.parameters(), rung)
    return _executed(store, made, facts, now, limit)


def _executed(store: Store, made: Plan, facts: Facts, now: datetime, limit: int) -> Answer:
    return execute(
        made,
        store,
        VocabularyLexicon(),
        now=now,
        limit=limit,
        parameters=facts.parameters(),
        facts=facts,
    )


def _of_the_unnamed(
    store: Store,
    answer: Answer,
    query: FormalQuery,
    facts: Facts,
    now: datetime,
    limit: int,
    rung: Precision | None,
) -> Answer | None:
    """Return the answer of what may be the named thing by another id; None where nothing may."""
    if not answer.named_alone:
        return None
    made = plan_of_the_unnamed(answer, planned(query, facts.parameters(), rung), facts)
    return None if made is None else _executed(store, made, facts, now, limit)


def _asks_for_the_unseen(query: FormalQuery) -> bool:
    """Say whether it is asked when or where a thing was not: no sighting shows that."""
    plain = query.relation is None and query.place is None
    return query.negated and plain and query.ask != "whether"


def _said(answer: Answer, query: FormalQuery, facts: Facts, now: datetime) -> Answer:
    """Return the answer with its sentence, and which of a place and a thing was meant.

    It is told of the query that was carried out, and bears the one that was asked.
    """
    answer, query = without_itself(answer, query), as_heard(query, facts)
    if answer.query is not None:
        answer = replace(answer, query=as_heard(answer.query, facts))
    answer = with_colours(answer, query, facts)
    told = everything_words(answer, query) or whose_words(answer, query, facts)
    told = told or sentence(answer, now=now)
    more = of_the_spot(query, facts), of_its_number(answer, query), of_its_clause(answer, query)
    said = " ".join(part for part in (told, *more) if part)
    if facts.meta(FORGOTTEN):
        said = but_forgotten(said, answer)
    begins_ms = facts.begins_ms() if answer.reason == "empty" else None
    if begins_ms is not None:
        said = not_begun_words(begins_ms, now)
    return told_as_place(replace(answer, query=query, answer=said), query, facts)


def explain(
    store: Store, text: str | FormalQuery, *, now: datetime, precision: str | None = None
) -> Explanation:
    """Answer a question and tell how; precision: as `ask` has it.

    Raises QuestionError, StoreError, and BadInput for an unknown precision.
    """
    rung = _precision(precision)
    native: list[NativeQuery] = []
    started = perf_counter()
    facts = Facts(store).as_of(now)
    query = read_question(store, text, now=now, facts=facts) if isinstance(text, str) else text
    parsed_ms = _ms_since(started)
    query, parameters = on_a_spot(query, facts), facts.parameters()
    steps = planned(query, parameters, rung)
    store.tracing(native.append)
    try:
        answer = _told(store, query, Facts(store).as_of(now), now, _told_from(query), rung)
    finally:
        store.tracing(None)
    elapsed = {"parse": parsed_ms} | answer.elapsed_ms | {"total": _ms_since(started)}
    return Explanation(query, steps, tuple(native), answer, elapsed)


def store_parameters(store: Store) -> Parameters:
    """Return the parameters that filled the store: it is asked with its own thresholds."""
    return Facts(store).parameters()


def refusal(error: QuestionError) -> Answer:
    """Return the answer that says why a question has no formal query, and what would do."""
    return Answer(
        text=error.text,
        status=cast("Status", error.kind),
        answer=str(error),
        message=error.reason,
        position=error.position,
        suggestions=error.suggestions,
    )


def failure(text: str, error: StoreError) -> Answer:
    """Return the answer of a store that failed; the message says which, and what would do."""
    return Answer(text=text, status="error", answer="I cannot reach my memory.", message=str(error))


def _precision(word: str | None) -> Precision | None:
    if word is None:
        return None
    for precision in PRECISIONS:
        if precision == word:
            return precision
    raise BadInput(f"precision {word!r} must be one of {', '.join(PRECISIONS)}")


def _ms_since(started: float) -> float:
    return (perf_counter() - started) * 1000
