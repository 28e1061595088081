"""What `it` means: after a statement the thing that it is about, else perhaps nothing at all."""

from __future__ import annotations

from dataclasses import replace

from grammar import scope, tagger, timespan
from grammar.cursor import Tag
from grammar.forms import ANYTHING, ObjectTerm
from grammar.nouns import Attribute, Noun
from grammar.nountags import PEOPLE
from grammar.phrases import phrases, place_follows
from grammar.vocabulary import Lexicon
from grammar.words import Word


def spoken_of(words: list[Word], lexicon: Lexicon) -> ObjectTerm | None:
    """Return the thing that a statement names, None where it names none.

    The first noun that the lexicon knows counts, else the last one with a determiner: `I want to
    read my novel. Where is it?`. People, places and times are no things; nor is what wants one.
    """
    timed = {i for time in timespan.find([w.text for w in words]) for i in range(*_span(time))}
    tags = tagger.tag([w for i, w in enumerate(words) if i not in timed], lexicon).tags
    named = [(i, _without_verb(t.value, lexicon)) for i, t in enumerate(tags) if _is_noun(t)]
    things = [(i, noun) for i, noun in named if _is_thing(noun, lexicon)]
    if len(words) > 1 and words[1].text.removesuffix("s") in _WANTING:
        things = [(i, noun) for i, noun in things if i]  # skipper wants his cap
    known = [(i, noun) for i, noun in things if noun.known]
    led = [(i, noun) for i, noun in things if i and tags[i - 1].type in ("DET", "OWNER", "ATTR")]
    chosen = known[:1] or led[-1:]
    return _term(tags, *chosen[0]) if chosen else None


def there(words: list[Word]) -> list[Word]:
    """Return the words with an `it` that means no thing as there: `is it a cup on the table`.

    It goes without saying in `anything left on the desk`.
    """
    opening = tuple(w.text for w in words[:3])
    if opening[:1] in _ANYTHING and len(words) > 2 and _left(opening[1]):
        return [replace(words[0], text="is"), replace(words[0], text="there"), *words]
    if opening[:2] not in _IT_IS or opening[2:] not in _SOME:
        return words
    if not any(place_follows(words, k) for k in range(4, len(words))):
        return words
    verb, it = sorted(words[:2], key=lambda w: w.text == "it")
    being = replace(verb, text=_BEING.get(verb.text, verb.text))
    return [being, replace(it, text="there"), *words[2:]]


def _left(verb: str) -> bool:
    """Whether a verb may tell what is done with a thing, and never what becomes of it."""
    kinds = {kind for parts, kind in phrases().by_first.get(verb, ()) if len(parts) == 1}
    return bool(kinds & {"SEE", "LEAVE", "FINDS"}) and kinds.isdisjoint(("MISSING", "MOVED"))


_ANYTHING = (("anything",), ("something",))
_WANTING = ("want", "need")
_IT_IS = (("is", "it"), ("was", "it"), ("it", "is"), ("it", "was"), ("has", "it"), ("it", "has"))
_SOME = (("a",), ("an",), ("any",), ("some",), ("no",))
_BEING = {"has": "is"}


def _span(time: timespan.Found) -> tuple[int, int]:
    return time.first, time.last


def _is_noun(tag: Tag) -> bool:
    return isinstance(tag.value, Noun)


def _without_verb(noun: object, lexicon: Lexicon) -> Noun:
    """Return a noun without the verb that follows it: `my flute needs` is my flute."""
    assert isinstance(noun, Noun)
    words = noun.said.split()
    verb = next((i for i, word in enumerate(words) if word in scope.doings()), len(words))
    if verb == len(words) or noun.said in lexicon.nouns:
        return noun
    said = lexicon.singular(" ".join(words[:verb]))
    return Noun(lexicon.canonical(said), said, said in lexicon.nouns)


def _is_thing(noun: Noun, lexicon: Lexicon) -> bool:
    words = {*noun.said.split()}
    is_place = noun.said in lexicon.places or noun.category == ANYTHING
    return bool(noun.said) and not is_place and not words & (PEOPLE | lexicon.names)


def _term(tags: list[Tag], i: int, noun: Noun) -> ObjectTerm:
    """Return the noun with the attributes and the owner said before it."""
    k = i
    described: list[str] = []
    while k and isinstance(value := tags[k - 1].value, Attribute):
        described.insert(0, value.said)
        k -= 1
    owner = str(tags[k - 1].value) if k and tags[k - 1].type == "OWNER" else None
    return ObjectTerm(noun.category, noun.said, tuple(described), owner=owner)
