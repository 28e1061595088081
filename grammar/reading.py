"""The reading of one text: words -> times -> terminals -> grammar -> formal query."""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from functools import lru_cache
from typing import Any

from grammar import antecedent, clock, lalr, scope, speech, tagger, timespan
from grammar.cursor import TIME_GAP, Tagged
from grammar.days import TimeAmbiguityError, TimeError, TimesApartError
from grammar.errors import Ambiguous, NotUnderstood, OutOfScope, QuestionError
from grammar.forms import FormalQuery, ObjectTerm, TimeSlice
from grammar.meaning import Meaning, MeaningError, query, readings
from grammar.suggestions import spelled, suggestions
from grammar.transform import Meanings
from grammar.vocabulary import Lexicon
from grammar.words import MAX_CHARACTERS, MAX_WORDS, Word, split

QUESTION = lalr.Source("question.lark", ("start", "fragment"))


@lru_cache(maxsize=1)
def _parser() -> lalr.Parser:
    return lalr.Parser(QUESTION.tables(), Meanings())


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
        for words in sentences:
            asks = scope.asks(words)
            try:
                answer = self.sentence(words, it)
                it = answer.objects[0] if answer.objects else it
            except QuestionError as error:
                it = it if asks else antecedent.spoken_of(words, self.lexicon) or it
                if asks or not failed_question:
                    failure = error
                failed_question = failed_question or asks
                if asks and words[0].text != speech.SEEK:  # "I need to go" after a question is none
                    answer = None
        if answer is None:
            raise failure
        return answer

    def sentence(self, words: list[Word], it: ObjectTerm | None) -> FormalQuery:
        """Read one sentence; `it` is what its pronouns mean."""
        found = self.terminals(words, it)
        meaning = self.parsed(found, "start")
        scope.refuse_noise(
            self.text, found.tagged, found.words, self.lexicon, timed=found.time is not None
        )
        return self.finished(meaning, found)

    def terminals(self, words: list[Word], it: ObjectTerm | None) -> Terminals:
        """Take the times out and type the words; raises what the words alone give away."""
        times = timespan.find([w.text for w in words])
        present = bool(times) and all(timespan.is_present(time.said) for time in times)
        rest, slice_ = self._timed(words, times)
        rest = scope.without_purpose(rest)
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
        tagged = found.tagged
        try:
            self._refuse_choice(meaning, found)
            done = query(meaning, self.text, found.time, tagged.select, tagged.negated)
        except MeaningError as error:
            raise self._refused(error, found.words) from error
        scope.refuse_late(self.text, done, found.words, self.lexicon)
        return done

    def _timed(
        self, words: list[Word], times: list[timespan.Found]
    ) -> tuple[list[Word], TimeSlice | None]:
        """Return the words without their times, and the slice that the times name together."""
        if not times:
            return words, None
        rest: list[Word] = []
        last = 0
        listed = timespan.listed(times, [w.text for w in words])
        for i, time in enumerate(times):
            joined = listed is not None and listed[0] < i <= listed[1]
            rest += [] if joined else words[last : time.first]
            rest.append(replace(words[time.first], text=TIME_GAP))
            last = time.last
        rest += words[last:]
        first = words[times[0].first]
        try:
            return rest, self._slice(words, times)
        except TimeAmbiguityError as error:
            raise self._ambiguous_date(words, error) from error
        except TimesApartError as error:
            raise self._ambiguous_times(words, times, error) from error
        except TimeError as error:
            said = self.text[first.start : words[times[-1].last - 1].end]
            raise NotUnderstood(
                self.text,
                first.start,
                f"“{said}” is no time I can place: {error}.",
                suggestions(rest, self.lexicon),
            ) from error

    def _slice(self, words: list[Word], times: list[timespan.Found]) -> TimeSlice:
        """Return the slice that the times name together."""
        said = timespan.joined(times, [w.text for w in words])
        return clock.resolve(said, self.now, month_first(self.now))

    def _ambiguous_times(
        self, words: list[Word], times: list[timespan.Found], error: TimesApartError
    ) -> QuestionError:
        """Return the question with each of two times that lie apart: on monday and friday."""
        pair = timespan.listed(times, [w.text for w in words])
        assert pair is not None  # only times that are listed lie apart
        spelled: list[str] = []
        first, last = words[times[pair[0]].first].start, words[times[pair[1]].last - 1].end
        for time in times[pair[0] : pair[1] + 1]:
            said = self.text[words[time.first].start : words[time.last - 1].end]
            spelled.append(f"{self.text[:first]}{said}{self.text[last:]}")
        return self._ambiguous(words[times[pair[0]].first].start, error, spelled[:3])

    def _ambiguous_date(self, words: list[Word], error: TimeAmbiguityError) -> QuestionError:
        """Return both readings of a date in digits, each spelled with its month's name."""
        date = next(w for w in words if timespan.is_slashed(w.text))
        spelled: list[str] = []
        for reading in error.readings:
            said = timespan.date_in_words(reading)
            spelled.append(f"{self.text[: date.start]}{said}{self.text[date.end :]}")
        return self._ambiguous(date.start, error, spelled)

    def _ambiguous(self, position: int, error: TimeError, spelled: list[str]) -> QuestionError:
        """Return the error that offers each spelling of the question with what it means."""
        try:
            queries = tuple(
                replace(self, text=text).of(
                    [speech.plain(s, self.lexicon) for s in speech.sentences(split(text))]
                )
                for text in spelled
            )
        except QuestionError as other:
            # the question fails however its time is read
            return replace(other, text=self.text, position=position)
        return Ambiguous(
            self.text, position, f"{str(error).capitalize()}.", tuple(spelled), queries
        )

    def _refused(self, error: MeaningError, rest: list[Word]) -> QuestionError:
        words = [w for w in rest if w.text != TIME_GAP]
        hints = suggestions(rest, self.lexicon)
        position = words[-1].start if words else 0
        if error.state:
            reason = f"A memory of sightings cannot answer that: {error}."
            return OutOfScope(self.text, position, reason, hints)
        return NotUnderstood(self.text, position, f"I could not follow: {error}.", hints)

    def _refuse_choice(self, meaning: Meaning, found: Terminals) -> None:
        """Raise Ambiguous where `or` leaves open which thing or place is meant."""
        choices = readings(meaning)
        if len(choices) == 1:
            return
        tagged = found.tagged
        queries = tuple(
            query(c, self.text, found.time, tagged.select, tagged.negated) for c in choices
        )
        raise Ambiguous(
            self.text,
            next((t.word.start for t in tagged.tags if t.type in ("OR", "OR_ITEM")), 0),
            "It asks one thing or another; ask for one at a time.",
            tuple(spelled(done) for done in queries[:3]),
            queries,
        )
