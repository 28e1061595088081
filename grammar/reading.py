"""The reading of one text: words -> times -> terminals -> grammar -> formal query."""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import datetime
from functools import lru_cache
from typing import Any

from grammar import (
    afterthought,
    antecedent,
    cutting,
    happenings,
    lalr,
    purpose,
    scope,
    speech,
    tagger,
    timespan,
    unseen,
)
from grammar.cursor import TIME_GAP, Tagged
from grammar.errors import Ambiguous, NotUnderstood, OutOfScope, QuestionError
from grammar.forms import FormalQuery, ObjectTerm, TimeSlice
from grammar.meaning import Meaning, MeaningError, form_of, query, readings
from grammar.suggestions import suggestions
from grammar.tense import asks_for_now, asks_where_it_has_been
from grammar.transform import Meanings
from grammar.vocabulary import Lexicon
from grammar.words import MAX_CHARACTERS, MAX_WORDS, Word, split

QUESTION = lalr.Source("question.lark", ("start", "fragment"))

_VERBAL = ("BE", "AUX", "WHO", "THERE", "SEE", "LEAVE", "FINDS", "MISSING", "MOVED", "GO")


@lru_cache(maxsize=1)
def _parser() -> lalr.Parser:
    return lalr.Parser(QUESTION.tables(), Meanings())


def capped(text: str) -> list[Word]:
    """Return the words of a text; raises NotUnderstood for one too long to be a question."""
    if len(text) > MAX_CHARACTERS:
        raise NotUnderstood(
            text, MAX_CHARACTERS, f"The question is longer than {MAX_CHARACTERS} characters."
        )
    found = split(text)
    if len(found) > MAX_WORDS:
        position = found[MAX_WORDS].start
        raise NotUnderstood(text, position, f"The question has more than {MAX_WORDS} words.")
    return found


def _told_when(asked: FormalQuery, told: FormalQuery | None, words: list[Word]) -> FormalQuery:
    """Return what was asked, of the time told before it: i left it here yesterday, where was it.

    What is asked of the present, or of the newest sighting, is of no time.
    """
    past = any(w.text in ("was", "were", "did") for w in words)
    if told is None or told.time is None or asked.time is not None or asked.ask != "where":
        return asked
    if not past or asked.select in ("last", "first") or told.objects[:1] != asked.objects[:1]:
        return asked
    form = form_of(asked.ask, asked.relation, told.time, asked.place, asked.select)
    return replace(asked, time=told.time, form=form)


def _seeks_it(words: list[Word]) -> bool:
    """Whether it is only told that what was asked for is wanted: i need them, i can't find it."""
    return words[0].text == speech.SEEK and words[1].text in ("it", "them")


@dataclass(frozen=True, slots=True)
class Terminals:
    """A sentence ready for the grammar: its words without times, their terminals, its slice."""

    words: list[Word]
    tagged: Tagged
    time: TimeSlice | None


@dataclass(frozen=True)
class Reading:
    """The reading of one text: what all its sentences share."""

    text: str
    now: datetime
    lexicon: Lexicon

    def of(self, sentences: list[list[Word]], it: ObjectTerm | None = None) -> FormalQuery:
        """Read the sentences; the last one that asks counts, earlier ones say what `it` is."""
        answer: FormalQuery | None = None
        failure: QuestionError = NotUnderstood(self.text, 0, "There is no question in it.")
        failed_question = False
        said: list[Word] = []
        for words in sentences:
            asks = scope.asks(words)
            if answer is not None and _seeks_it(words):
                continue
            if said and not asks:
                more = afterthought.told_of(self, answer, said, words) if answer else None
                if more:
                    (answer, said), it = more, more[0].objects[0]
                    continue
                if answer is not None and afterthought.narrows(words):
                    raise NotUnderstood(self.text, words[0].start, "I cannot tell which you mean.")
                if answer is None and afterthought.is_bare(self, words):
                    it = it and afterthought.it_described(self, it, words)
                    if failed_question or it is not None:
                        continue  # is the cup clean? the red one
            said = words
            try:
                told, answer = answer, self.sentence(words, it)
                answer = _told_when(answer, told, words)
                it = answer.objects[0] if answer.objects else it
            except QuestionError as error:
                it = it if asks else self._spoken_of(words) or it
                if asks or not failed_question:
                    failure = error
                failed_question = failed_question or asks
                if asks and words[0].text != speech.SEEK:  # "I need to go" after a question is none
                    answer = None
        if answer is None:
            raise failure
        return answer

    def _spoken_of(self, words: list[Word]) -> ObjectTerm | None:
        """Return what a statement is about, as it is told: he wants his cap, the white one."""
        it = antecedent.spoken_of(words, self.lexicon)
        pause = next((i for i, w in enumerate(words) if w.text == ","), 0)
        if it is None or not 0 < pause < len(words) - 1:
            return it
        return afterthought.it_described(self, it, words[pause + 1 :]) or it

    def sentence(self, words: list[Word], it: ObjectTerm | None) -> FormalQuery:
        """Read one sentence; `it` is what its pronouns mean."""
        found = self.terminals(words, it)
        meaning = self.parsed(found, "start")
        placed = meaning.ask == "where" and meaning.things.items and self._questioned(words)
        denied = found.tagged.negated and meaning.ask in ("where", "what")  # nothing on the table
        if (placed or denied) and self._alone(found):
            meaning = replace(meaning, ask="whether", newest=False)  # my keys on the table?
        scope.refuse_noise(
            self.text, found.tagged, found.words, self.lexicon, timed=found.time is not None
        )
        return self.finished(meaning, found)

    def _alone(self, found: Terminals) -> bool:
        """Whether a thing and its place are said alone, with no verb and no question word."""
        return not any(t.type[0] == "_" or t.type in _VERBAL for t in found.tagged.tags)

    def _questioned(self, words: list[Word]) -> bool:
        """Whether a question mark ends the words."""
        ends = self.text[words[-1].end :].lstrip().lower()
        return ends.startswith(("?", "question mark"))

    def again(self, text: str) -> FormalQuery:
        """Read another spelling of the text, its times said in another way."""
        plain = [speech.plain(words, self.lexicon) for words in cutting.sentences(split(text))]
        return replace(self, text=text).of(plain)

    def terminals(self, words: list[Word], it: ObjectTerm | None) -> Terminals:
        """Take the times out and type the words; raises what the words alone give away."""
        words = words if it is not None else antecedent.there(words)
        words = happenings.without_happenings(words)
        times = timespan.find([w.text for w in words])
        rest, present = words, False
        slice_: TimeSlice | None = None
        if times:
            from grammar import placing  # half of the questions name no time and need no clock

            rest, slice_, present = placing.placed(self, words, times)
        rest = purpose.without_purpose(rest)
        scope.refuse_early(self.text, words, rest, self.lexicon, it)
        tagged = tagger.tag(rest, self.lexicon, it)
        if present:  # where is it now asks for the newest sighting, as where is it does
            slice_, tagged.select = None, tagged.select or "last"
        return Terminals(rest, tagged, slice_)

    def parsed(self, found: Terminals, start: str) -> Any:
        """Parse the terminals from the rule `start`."""
        tags = found.tagged.tags
        try:
            return _parser().parse(tags, start)
        except MeaningError as error:
            raise self._refused(error, found.words) from error
        except lalr.UnreadError as error:
            word = tags[error.index].word if error.index < len(tags) else None
            raise scope.unread(self.text, found.words, word, found.tagged, self.lexicon) from error

    def finished(self, meaning: Meaning, found: Terminals) -> FormalQuery:
        """Return the query of a meaning; raises Ambiguous, and OutOfScope for what is no thing."""
        try:
            queries = tuple(self._query(each, found) for each in readings(meaning))
            done = queries[0] if len(queries) == 1 else self._as_one(queries, meaning, found)
        except MeaningError as error:
            raise self._refused(error, found.words) from error
        unseen.refuse_late(self.text, done, found.words, self.lexicon)
        return done

    def _query(self, meaning: Meaning, found: Terminals) -> FormalQuery:
        said = found.tagged
        asked = query(
            meaning, self.text, found.time, said.select, said.negated, said.never, said.contrary
        )
        if said.select is None and asks_where_it_has_been(asked):
            asked = replace(asked, select="all")
        return replace(asked, now=asks_for_now(asked))

    def _refused(self, error: MeaningError, rest: list[Word]) -> QuestionError:
        words = [w for w in rest if w.text != TIME_GAP]
        hints = suggestions(rest, self.lexicon, self.text)
        position = words[-1].start if words else 0
        if error.state:
            reason = f"A memory of sightings cannot answer that: {error}."
            return OutOfScope(self.text, position, reason, hints)
        return NotUnderstood(self.text, position, f"I could not follow: {error}.", hints)

    def _as_one(
        self, queries: tuple[FormalQuery, ...], meaning: Meaning, found: Terminals
    ) -> FormalQuery:
        """Return what is one query in two words, or of either; raises Ambiguous where it is two."""
        from grammar.alternatives import united  # few questions say `or`
        from grammar.choices import as_one, choices

        one = as_one(queries)
        if one is not None:
            return one
        either = united(meaning)
        if either is not None and len(open_left := readings(either)) == 1:
            return self._query(open_left[0], found)
        tags = found.tagged.tags
        raise Ambiguous(
            self.text,
            next((t.word.start for t in tags if t.type in ("OR", "OR_ITEM")), 0),
            "It asks more than one thing; ask for one at a time.",
            choices(self.text, found.words, tags, queries[:3], self.again),
            queries,
        )
