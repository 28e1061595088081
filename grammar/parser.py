"""The parser: a question in English to its formal query.

Stages: words -> plain speech -> spoken times out -> spelling -> terminals -> grammar -> query.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from functools import lru_cache

from lark import Lark, Token
from lark.exceptions import UnexpectedInput

from grammar import clock, lalr, scope, speech, spelling, tagger, timespan
from grammar.days import TimeAmbiguity
from grammar.errors import Ambiguous, NotUnderstood, OutOfScope, QuestionError
from grammar.forms import FormalQuery, ObjectTerm, TimeSlice
from grammar.meaning import Meaning, MeaningError, query, readings
from grammar.spelling import Correction
from grammar.transform import Meanings
from grammar.vocabulary import Lexicon, StoreWords, lexicon
from grammar.words import MAX_CHARACTERS, MAX_WORDS, Word, split

_TERMINALS = (
    "AND ATTR AT_PLACE AUX BE DET HAVE HERE GO MISSING MOVED NOT_ATTR NOUN NUMBER ONE OR OR_ITEM OWNED OWNER "
    "PART PREDICATE REL SIDE_BY_SIDE STATE THAT_NOT THAT_NOT_REL THERE UNKNOWN WHO SEE LEAVE FINDS "
    "_EXCEPT _FIND _HOWLONG _HOWMANY _HOWOFTEN _MADE_OF _NOT_MADE_OF _SEEK _SHOW _THAT_IS "
    "_THAT_IS_NOT _WHAT _WHEN _WHERE _WHETHER _WHICH _WITHOUT_PART _WITH_PART"
).split()
NO_STORE = StoreWords()


@dataclass(frozen=True, slots=True)
class Parsed:
    """A formal query, and the spelling corrections that it rests on."""

    query: FormalQuery
    corrections: tuple[Correction, ...] = ()


@lru_cache(maxsize=1)
def _question_parser() -> Lark:
    return lalr.parser("question.lark", tuple(_TERMINALS), Meanings())


def month_first(now: datetime) -> bool | None:
    """Return whether the country of `now`'s zone writes the month first, None where unknown.

    A named zone of the Americas and an offset that only the Americas have write 3/4 for March 4.
    """
    key = str(getattr(now.tzinfo, "key", ""))
    if key.startswith(("America/", "US/")):
        return True
    if "/" in key and not key.startswith("Etc/"):
        return False
    offset = now.utcoffset()
    return True if offset is not None and offset <= timedelta(hours=-4) else None


def parse(text: str, *, now: datetime, words: StoreWords = NO_STORE) -> FormalQuery:
    """Return the formal query of a question.

    now: aware, in the home's zone; all times of the query are in that zone.
    words: a store's categories, taught names and places, which count as known words.
    Raises QuestionError (OutOfScope, NotUnderstood, Ambiguous) and nothing else.
    """
    return parse_report(text, now=now, words=words).query


def parse_report(text: str, *, now: datetime, words: StoreWords = NO_STORE) -> Parsed:
    """Return what `parse` returns, with the spelling corrections it rests on."""
    if now.tzinfo is None:
        raise ValueError("now has no zone; hand in an aware datetime")
    lex = lexicon(words)
    found = _capped(text)
    found, corrections = spelling.corrected(found, lex, words)
    sentences = [plain for s in speech.sentences(found) if (plain := speech.plain(s, lex))]
    if not sentences:
        raise NotUnderstood(
            text, 0, "There is no question in it.", scope.suggestions(text, [], lex)
        )
    return Parsed(Reading(text, now, lex).of(sentences), corrections)


def _capped(text: str) -> list[Word]:
    if len(text) > MAX_CHARACTERS:
        raise NotUnderstood(
            text, MAX_CHARACTERS, f"The question is longer than {MAX_CHARACTERS} characters."
        )
    found = split(text)
    if len(found) > MAX_WORDS:
        position = found[MAX_WORDS].start
        raise NotUnderstood(text, position, f"The question has more than {MAX_WORDS} words.")
    return found


@dataclass(frozen=True)
class Reading:
    """The reading of one text: what all its sentences share."""

    text: str
    now: datetime
    lexicon: Lexicon

    def of(self, sentences: list[list[Word]]) -> FormalQuery:
        """Read the sentences; the last one that asks counts, earlier ones say what `it` is."""
        it: ObjectTerm | None = None
        answer: FormalQuery | None = None
        failure: QuestionError | None = None
        for words in sentences:
            try:
                answer = self.sentence(words, it)
                it = answer.objects[0] if answer.objects else it
            except QuestionError as error:
                if failure is None or scope.asks(words):
                    failure = error
                if scope.asks(words):
                    answer = None
        if answer is not None:
            return answer
        assert failure is not None
        raise failure

    def sentence(self, words: list[Word], it: ObjectTerm | None) -> FormalQuery:
        """Read one sentence."""
        times = timespan.find([w.text for w in words])
        rest, slice_ = self._timed(words, times)
        rest = scope.without_purpose(rest)
        scope.refuse_early(self.text, words, rest, self.lexicon, it)
        tagged = tagger.tag(rest, self.lexicon, it)
        meaning = self._meaning(tagged, rest, timed=bool(times))
        try:
            self._refuse_choice(meaning, tagged, slice_)
            found = query(meaning, self.text, slice_, tagged.select, tagged.negated)
        except MeaningError as error:
            raise self._refused(error, rest) from error
        scope.refuse_late(self.text, found, rest, self.lexicon)
        return found

    def _timed(
        self, words: list[Word], times: list[timespan.Found]
    ) -> tuple[list[Word], TimeSlice | None]:
        """Return the words without their times, and the slice that the times name together."""
        if not times:
            return words, None
        rest: list[Word] = []
        last = 0
        for time in times:
            rest += words[last : time.first]
            rest.append(replace(words[time.first], text=tagger.TIME_GAP))
            last = time.last
        rest += words[last:]
        first = words[times[0].first]
        try:
            return rest, clock.resolve(timespan.joined(times), self.now, month_first(self.now))
        except TimeAmbiguity as error:
            raise self._ambiguous_date(words, times, error) from error
        except clock.TimeError as error:
            said = self.text[first.start : words[times[-1].last - 1].end]
            raise NotUnderstood(
                self.text, first.start, f"“{said}” is no time I can place: {error}."
            ) from error

    def _ambiguous_date(
        self, words: list[Word], times: list[timespan.Found], error: TimeAmbiguity
    ) -> Ambiguous:
        readings, spelled = [], []
        start = words[times[0].first].start
        for first in (True, False):
            zone = self.now
            slice_ = clock.resolve(timespan.joined(times), zone, first)
            moment = slice_.start or slice_.end
            assert moment is not None
            day = f"{moment:%B} {moment.day}, {moment.year}"
            date = next(
                w
                for w in words[times[0].first :]
                if "/" in w.text or "-" in w.text or "." in w.text
            )
            said = f"{self.text[: date.start]}{day}{self.text[date.end :]}"
            spelled.append(said)
            readings.append(
                Reading(said, zone, self.lexicon).of([*speech.sentences(split(said))]).query
            )
        return Ambiguous(
            self.text, start, f"{str(error).capitalize()}.", tuple(spelled), tuple(readings)
        )

    def _meaning(self, tagged: tagger.Tagged, rest: list[Word], *, timed: bool) -> Meaning:
        tokens = [
            Token(t.type, t.value, start_pos=i)  # type: ignore[arg-type]
            for i, t in enumerate(tagged.tags)
        ]
        try:
            meaning = _question_parser().parse(tokens)  # type: ignore[arg-type]
        except MeaningError as error:
            raise self._refused(error, rest) from error
        except UnexpectedInput as error:
            token = getattr(error, "token", None)
            index = getattr(token, "start_pos", None)
            at_end = token is None or token.type == "$END" or index is None
            word = None if at_end else tagged.tags[index].word
            raise scope.unread(self.text, rest, word, tagged, self.lexicon) from error
        scope.refuse_noise(self.text, tagged, rest, self.lexicon, timed=timed)
        assert isinstance(meaning, Meaning)
        return meaning

    def _refused(self, error: MeaningError, rest: list[Word]) -> QuestionError:
        kind = OutOfScope if error.state else NotUnderstood
        position = rest[-1].start if rest else 0
        return kind(
            self.text,
            position,
            f"A memory of sightings cannot answer that: {error}."
            if error.state
            else f"I could not follow the question: {error}.",
            scope.suggestions(self.text, rest, self.lexicon),
        )

    def _refuse_choice(
        self, meaning: Meaning, tagged: tagger.Tagged, time: TimeSlice | None
    ) -> None:
        """Raise Ambiguous where `or` leaves open which thing or place is meant."""
        choices = readings(meaning)
        if len(choices) == 1:
            return
        queries = tuple(query(c, self.text, time, tagged.select, tagged.negated) for c in choices)
        spelled = tuple(scope.spelled(found) for found in queries[:3])
        raise Ambiguous(
            self.text,
            next((t.word.start for t in tagged.tags if t.type in ("OR", "OR_ITEM")), 0),
            "It asks one thing or another; ask for one at a time.",
            spelled,
            queries,
        )
