"""A conversation with one store: each saying is understood after the one before it.

A saying is a question, a follow-up of the question before, a word about a row of its answer ("not
this one"), something taught ("these are my keys"), or one of the choices that were offered.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from datetime import datetime
from time import perf_counter
from typing import TYPE_CHECKING, Literal

from assistant.asking import ask, ask_query, explain, failure, refusal, store_words
from assistant.courtesies import courteous
from assistant.dialogue import Seen, follow, is_about_the_same, is_beside, is_of_the_listed
from assistant.phrases import heads_of
from assistant.pointing import (
    NOTHING_SHOWN,
    AskedOf,
    Chosen,
    NotThis,
    Others,
    Pointing,
    find_row,
    is_of,
    narrowed,
    of_the_told,
    other_thing,
    read_pointing,
    row_words,
    same_place,
    same_row,
    shown,
    term_of_row,
    told,
)
from assistant.refusals import all_refused
from assistant.session import Pointer
from assistant.taught import Boxing, Naming, Teaching, Undoing, is_lesson, read_teaching, row_of
from d3a.answer import Answer, RankedKeyframe, Status
from d3a.answering.facts import Facts
from d3a.store.base import Store, StoreError
from grammar.errors import QuestionError
from grammar.forms import FormalQuery
from grammar.fragments import is_list
from grammar.notation import looks_formal, read, write

if TYPE_CHECKING:
    from assistant.remembering import Learned

Keep = Callable[[RankedKeyframe], bool]
_THERE = re.compile(r"\b(?:it|they|them|one) there\b")
_PRONOUN = re.compile(r"\b(?:it|they|them|its|their)\b")
_ASKED = re.compile(r"[^?]*\w[^?]*(?:\?+|$)")
"""Each question of a saying; what is only told before one belongs to it."""
_RETRY = frozenset({"again", "try again", "ask again", "retry", "once more"})
_YES = frozenset(
    {"yes", "yes please", "yes it is", "yes they are", "sure", "right", "correct", "do"}
)
_NO = frozenset({"no", "no thanks", "no thank you", "nope", "better not"})
"""What is said to the one thing that was offered."""
_OTHER = frozenset({"the other", "the other one", "other", "the latter"})
"""What is said to the second of two."""


@dataclass(frozen=True, slots=True)
class _Said:
    """What was said so far, as far as it counts for what is said next.

    last: the query understood last. refused: rows whose things it does not mean. meant: the object
    that was chosen by its number, None for none. text: what was asked last, to try it again.
    """

    last: FormalQuery | None = None
    answer: Answer | None = None
    refused: tuple[RankedKeyframe, ...] = ()
    meant: str | None = None
    text: str = ""
    choices: tuple[str, ...] = field(default=())


class Conversation:
    """Asks a store, and keeps what was said, for "and yesterday?" and "not this one".

    now: the moment to ask at, in the home's zone. One thread at a time.
    """

    def __init__(self, store: Store, now: Callable[[], datetime]) -> None:
        self._store = store
        self._now = now
        self._said = _Said()
        self.pointer = Pointer()

    def ask(self, text: str) -> Answer:
        """Answer whatever was said. What cannot be answered is an answer with its status.

        A question that was not understood, or is about a thing that nobody knows, leaves the one
        before it in force.
        """
        text, declined = self._picked(text), len(self._said.choices) == 1 and _plain(text) in _NO
        if declined:
            self._said = replace(self._said, choices=())
            return self._beside_rows(text, "All right, I leave it as it is.", "found")
        polite = courteous(text)
        if polite is not None:
            return self._beside_rows(text, polite, "found")
        teaching = None if looks_formal(text) else read_teaching(text)
        if teaching is not None:
            return self._offering(self._teach(text, teaching))
        pointing = read_pointing(text)
        if pointing is not None and self._is_of_rows(pointing):
            return self._offering(self._point(text, pointing))
        return self._offering(self._questions(text))

    def _picked(self, text: str) -> str:
        """Return the choice that a number names, where choices were offered; else the text."""
        said, choices = _plain(text), self._said.choices
        if said in _RETRY and self._said.text:
            return self._said.text
        if said in _YES and len(choices) == 1:
            return choices[0]
        if said in _OTHER and len(choices) == 2:
            return choices[1]
        number = row_of(said) if len(said.split()) <= 3 and said not in _OTHER else None
        if choices and number is not None and -1 <= number <= len(choices) and number != 0:
            return choices[number - 1 if number > 0 else -1]
        return text

    def _offering(self, answer: Answer) -> Answer:
        """Keep what an answer offers to say next."""
        offered = answer.suggestions if not answer.keyframes or answer.query is None else ()
        self._said = replace(self._said, choices=offered)
        return answer

    # questions and follow-ups

    def _questions(self, text: str) -> Answer:
        """Answer each question of one saying, the later ones after the earlier, all in words.

        The rows are those of the last. Where one is not understood, the saying is read as one.
        """
        parts, before, row = _ASKED.findall(text), self._said, self.pointer.row
        if len(parts) < 2 or looks_formal(text):
            return self._question(text)
        answers = [self._question(part.strip()) for part in parts]
        if any(answer.status not in ("found", "not_found") for answer in answers):
            self._said = before
            self.pointer.to(row)
            return self._question(text)
        self._said = replace(self._said, text=text)
        words = " ".join(answer.answer or "" for answer in answers)
        return replace(answers[-1], text=text, answer=words)

    def _question(self, text: str) -> Answer:
        before, told_of, row = self._said, of_the_told(self._said.answer), self.pointer.row
        self._said = replace(before, text=text)
        if told_of is not None and _PRONOUN.search(text.lower()):
            other = told_of.otherwise
            before = replace(before, last=told_of.query, meant=other.object_id if other else None)
        answer, spoken = self._answer(text, before.last)
        if spoken is None or answer.status not in ("found", "not_found"):
            return answer
        heard = replace(spoken, corrections=())  # told once, not with each answer again
        same = is_about_the_same(heard, before.last, text)
        refused = before.refused if same else ()
        meant = before.meant if same and heard.ask != "count" else None
        if row is not None and is_of_the_listed(heard, before.last, _seen(row, before.last), text):
            meant = row.object_id
        answer = self._as_meant(answer, refused, meant, before.last)
        if heard.ask == "what" and len(alone := {k.object_id for k in heads_of(answer)}) == 1:
            meant = meant or next(iter(alone))  # which cup is there: this one, from now on
        self._said = _Said(heard, answer, refused, meant, text)
        self.pointer.to(told(answer))
        return answer

    def _answer(self, text: str, last: FormalQuery | None) -> tuple[Answer, FormalQuery | None]:
        """Return the answer and the query as it was spoken: the answer's own has places in it."""
        started, now, facts = perf_counter(), self._now(), None
        try:
            if looks_formal(text):
                query = read(text, now=now)
            else:
                facts, seen = Facts(self._store).as_of(now), _seen(self.pointer.row, last)
                words = store_words(self._store, facts)
                query = follow(text, now=now, words=words, last=last, seen=seen)
        except QuestionError as error:
            return refusal(error), None
        except StoreError as error:
            return replace(failure(text, error), suggestions=(text,)), None
        parse_ms = (perf_counter() - started) * 1000
        answer = ask_query(self._store, query, now=now, facts=facts)
        if answer.status == "error":
            answer = replace(answer, suggestions=(text,))
        elapsed = {"parse": parse_ms} | answer.elapsed_ms
        elapsed |= {"total": (perf_counter() - started) * 1000}
        return replace(answer, elapsed_ms=elapsed), query

    def _as_meant(
        self,
        answer: Answer,
        refused: tuple[RankedKeyframe, ...],
        meant: str | None,
        last: FormalQuery | None,
    ) -> Answer:
        """Return the answer without what was refused; of the thing meant, where that is known.

        last: the query before.

        "Before that" asks for another place than that of the row told, "there" for the same.
        """
        query = answer.query
        assert query is not None
        row, now, seen = self.pointer.row, self._now(), _seen(self.pointer.row, query)
        if refused:
            answer = self._without(answer, refused)
        nearby: Keep | None = None
        nothing, somewhere = "", query.place is not None or query.relation is not None
        if row is not None and is_beside(query, seen, last):
            nearby, nothing = (lambda k: not same_place(k, row)), _nowhere_else(query)
        elif row is not None and not somewhere and _THERE.search(answer.text.lower()):
            nearby, nothing = (lambda k: same_place(k, row)), "I did not see it there then."
        if meant is not None:
            of_it = narrowed(answer, lambda k: k.object_id == meant, now, nothing=nothing)
            there = narrowed(of_it, nearby, now, nothing=nothing) if nearby else of_it
            if shown(there):
                return there
        return narrowed(answer, nearby, now, nothing=nothing) if nearby else answer

    def _without(self, answer: Answer, refused: tuple[RankedKeyframe, ...]) -> Answer:
        def is_left(keyframe: RankedKeyframe) -> bool:
            return not any(is_of(keyframe, row) for row in refused)

        return narrowed(answer, is_left, self._now(), nothing=all_refused(answer))

    # words about the rows

    def _is_of_rows(self, pointing: Pointing) -> bool:
        """Whether a saying is about the list: the one shown, one used up, or none yet."""
        said = self._said
        if shown(said.answer):
            return True
        if isinstance(pointing, AskedOf):
            return said.last is None and pointing != AskedOf("when", None)
        return said.last is None or bool(said.refused)

    def _point(self, text: str, pointing: Pointing) -> Answer:
        rows = shown(self._said.answer)
        ask_: Literal["when", "where"] = "where"
        match pointing:
            case NotThis():
                return self._refuse(text, self._row(pointing.row))
            case Chosen():
                row = self._row(pointing.row)
                if pointing.step:
                    row = other_thing(rows, self.pointer.row, pointing.step)
            case AskedOf():
                row, ask_ = self._row(pointing.row), pointing.ask
            case Others():
                row = None if self._is_list() else other_thing(rows, self.pointer.row, 1)
        if row is None and rows and isinstance(pointing, Others):
            every = "All that I saw stands in the list." if self._is_list() else "I saw no other."
            return self._beside_rows(text, every, "found" if self._is_list() else "not_found")
        if row is None:
            return self._no_row(text)
        if pointing != AskedOf(ask_, None):
            self._said = replace(self._said, meant=row.object_id)
        self.pointer.to(row)
        shown_for = self._said.answer.query if self._said.answer is not None else None
        sentence = row_words(row, shown_for, ask=ask_, now=self._now())
        return self._beside_rows(text, sentence, "found")

    def _is_list(self) -> bool:
        return self._said.last is not None and is_list(self._said.last)

    def _row(self, number: int | None) -> RankedKeyframe | None:
        if number is None:
            return self.pointer.row
        return find_row(shown(self._said.answer), number)

    def _no_row(self, text: str) -> Answer:
        count = len(shown(self._said.answer))
        if self._said.last is None:
            return self._beside_rows(text, f"There is no list yet. {NOTHING_SHOWN}", "not_found")
        words = (
            "There is one in the list."
            if count == 1
            else f"There are {count or 'none'} in the list."
        )
        return self._beside_rows(text, f"There is no such row. {words}", "not_found")

    def _refuse(self, text: str, row: RankedKeyframe | None) -> Answer:
        """Answer the question again without a thing that is not meant; None where all were said."""
        last = self._said.last
        if last is None or (row is None and (shown(self._said.answer) or not self._said.refused)):
            return self._no_row(text)
        refused = self._said.refused if row is None else (*self._said.refused, row)
        answer = ask_query(self._store, last, now=self._now())
        if answer.status == "error":
            return replace(answer, text=text, suggestions=(text,))
        answer = replace(self._without(answer, refused), text=text)
        self._said = replace(self._said, answer=answer, refused=refused, meant=None, text=text)
        self.pointer.to(told(answer))
        return answer

    # teaching

    def _teach(self, text: str, teaching: Teaching) -> Answer:
        from assistant.remembering import Scene, learn  # a chat that is not taught goes without

        scene = Scene(shown(self._said.answer), self.pointer.row, self.pointer.box)
        try:
            learned = learn(self._store, teaching, scene, self._now())
        except StoreError as error:
            return replace(failure(text, error), suggestions=(text,))
        if learned is None:
            assert isinstance(teaching, Naming)  # of the others each has something to say
            return self._refuse(text, scene.row(teaching.row))
        if isinstance(teaching, Boxing):
            self.pointer.box = teaching.box if learned.done else None
        elif learned.done:
            self.pointer.box = None
            if isinstance(teaching, Undoing):  # what it was may be what is meant after all
                self._said = replace(self._said, refused=())
            self._look_again()
        if learned.refused is not None:
            next_best = self._refuse(text, learned.refused)
            return replace(next_best, answer=f"{learned.sentence} {next_best.answer}")
        return self._learned(text, learned)

    def _learned(self, text: str, learned: Learned) -> Answer:
        refused: Status = "ambiguous" if learned.choices else "not_found"
        status: Status = "found" if learned.done else refused
        answer = self._beside_rows(text, learned.sentence, status)
        return replace(answer, suggestions=learned.choices)

    def _look_again(self) -> None:
        """Ask the last question again: what was taught may have changed its answer."""
        last, row = self._said.last, self.pointer.row
        if last is None:
            return
        answer = ask_query(self._store, last, now=self._now())
        if answer.status not in ("found", "not_found"):
            self._said = replace(self._said, answer=None, meant=None)
            self.pointer.to(None)
            return
        if self._said.refused:
            answer = self._without(answer, self._said.refused)
        self._said = replace(self._said, answer=answer, meant=None)
        self.pointer.to(same_row(shown(answer), row) or told(answer))

    def _beside_rows(self, text: str, sentence: str, status: Status) -> Answer:
        """Return a sentence beside the rows that are shown already."""
        rows = shown(self._said.answer)
        done: Answer = replace(
            self._said.answer or Answer(), text=text, answer=sentence, query=None, status=status,
            keyframes=rows, otherwise=None, suggestions=(), unjudged=(), truncated=False,
            reason=None, elapsed_ms={},
        )  # fmt: skip
        return done

    # beside the conversation

    def teaches(self, text: str) -> bool:
        """Whether a saying, or the choice that it takes, changes what is known."""
        return not looks_formal(text) and is_lesson(self._picked(text))

    def alone(self, text: str) -> Answer:
        """Answer a question by itself: neither after nor before another."""
        return ask(self._store, text, now=self._now())

    def explain(self, text: str) -> str:
        """Return the query, plan and native queries of what was asked last, else of `text`.

        Raises QuestionError and StoreError.
        """
        said = self._said
        spoken = read_pointing(text) is not None or read_teaching(text) is not None
        if said.last is not None and (spoken or said.last.text == text):
            text = write(said.last)
        return explain(self._store, text, now=self._now()).to_text()


def _nowhere_else(query: FormalQuery) -> str:
    beside = "before" if query.time is not None and query.time.start is None else "after"
    return f"I did not see it anywhere else {beside} that."


def _plain(text: str) -> str:
    return " ".join(text.replace(",", " ").split()).rstrip(" .!").lower()


def _seen(row: RankedKeyframe | None, query: FormalQuery | None) -> Seen | None:
    return None if row is None else Seen(row.start, row.end, term_of_row(row, query), row.place)
