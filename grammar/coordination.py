"""What is said once for two: on or under the table, anna's and tom's keys, a red or blue cup."""

from __future__ import annotations

from dataclasses import replace

from grammar.closed import is_open, words_of
from grammar.cursor import DETERMINERS, OWNERS, TIME_GAP
from grammar.nountags import PEOPLE
from grammar.phrases import breaks, phrases
from grammar.vocabulary import Lexicon
from grammar.vocabulary.words import singular
from grammar.words import Word

_SIDES = ("left", "right")
_JOINTS = ("and", "or")
_JOINING = frozenset((*_JOINTS, "nor", "neither"))
_STRANDED = ("in", "on", "at")
_THE = ("the", "my", "our", "your", "these", "those")
_ONE_LOOK = {"black", "white"}
_WORN = "clothes"


def spread(words: list[Word], lexicon: Lexicon) -> list[Word]:
    """Give each of two relations, owners or looks the noun phrase that is said once."""
    words = _last_before(words)
    if _JOINING.isdisjoint([word.text for word in words]):
        return words  # most join nothing
    words = _unpaused(_listed_looks(_denied_each(words), lexicon), lexicon)
    for k in range(len(words) - 3, 0, -1):  # what is spread goes before it
        if words[k].text in _JOINTS:
            words = (
                _related(words, k)
                or _owned(words, k)
                or _looking(words, k, lexicon)
                or _looking_each(words, k, lexicon)
                or words
            )
    return words


def _unpaused(words: list[Word], lexicon: Lexicon) -> list[Word]:
    """Say `and` between things of a list that a recogniser gives no pause: keys wallet and phone.

    Several of a kind lead no noun: but for what they are kept in, that is two.
    """
    end = next((k for k in range(len(words) - 1, 1, -1) if words[k].text == "and"), 0)
    out: list[Word] = []
    listed = False
    for i, word in enumerate(words):
        out.append(word)
        following = words[i + 1].text if i + 1 < end else ""
        several = lexicon.singular(word.text) != word.text
        person = lexicon.singular(word.text) in PEOPLE
        apart = (several or listed) and not person and following not in _KEEPING
        listed = (
            apart
            and all(lexicon.known_noun(text) for text in (word.text, following))
            and lexicon.known_noun(f"{word.text} {following}") is None
        )
        out += [replace(words[i + 1], text="and")] if listed else []
    return out


_KEEPING = words_of(
    "case box bag basket rack shelf drawer cabinet holder stand hook jar tin tray bin bowl bucket "
    "container cupboard hanger organizer organiser ring book cover"
)


def _denied_each(words: list[Word]) -> list[Word]:
    """Say `not` of each that is denied: neither red nor blue is not red and not blue.

    What shares the preposition shares its `not`: neither in the kitchen nor the hall.
    """
    out: list[Word] = []
    shared = False
    for word, following in zip(words, (*(w.text for w in words[1:]), ""), strict=True):
        led = following in DETERMINERS or following in OWNERS
        if word.text == "neither" and following not in ("of", ""):
            shared = not led
            out.append(replace(word, text="not"))
        elif word.text == "nor" and led and shared:
            out.append(replace(word, text="or"))
        elif word.text == "nor":
            out += [replace(word, text="and"), replace(word, text="not")]
        else:
            out.append(word)
    return out


def _listed_looks(words: list[Word], lexicon: Lexicon) -> list[Word]:
    """Say `or` between all looks of a list that ends so: a red, blue or green cup."""
    looks = lexicon.attributes.keys() | lexicon.shades
    for k in (k for k, word in enumerate(words) if word.text == "or"):
        i = k - 1
        i -= i > 0 and words[i].text == ","  # red, blue, or green
        while i > 1 and words[i].text in looks and words[i - 1].text == ",":
            words = [*words[: i - 1], replace(words[i - 1], text="or"), *words[i:]]
            i -= 2
    return words


def _last_before(words: list[Word]) -> list[Word]:
    """Say `last` before the preposition that ends a question: what room was it in last."""
    if len(words) > 2 and words[-1].text == "last" and words[-2].text in _STRANDED:
        return [*words[:-2], words[-1], words[-2]]
    return words


def _related(words: list[Word], k: int) -> list[Word] | None:
    """Spread on the table or under the table, left or right of it."""
    size = _relation_at(words, k + 1)
    sided = words[k - 1].text in _SIDES and words[k + 1].text in _SIDES
    if words[k].text != "or" or not size or not (sided or _relation_ends(words, k)):
        return None
    start = k + 1 + size
    end = next((i for i in range(start, len(words)) if words[i].text == TIME_GAP), len(words))
    if start == end:
        return None
    link = [replace(words[k], text="of")] if sided else []
    return [*words[:k], *link, *words[start:end], *words[k:]]


def _owned(words: list[Word], k: int) -> list[Word] | None:
    """Spread anna's keys and tom's keys, my cup or your cup."""
    if not (_is_owner(words[k - 1]) and _is_owner(words[k + 1])):
        return None
    end = _open_end(words, k + 2)
    return [*words[:k], *words[k + 2 : end], *words[k:]] if end > k + 2 else None


def _looking(words: list[Word], k: int, lexicon: Lexicon) -> list[Word] | None:
    """Spread a light blue cup or a dark blue cup; looks that are joined by `and` are of one."""
    looks = lexicon.attributes.keys() | lexicon.shades
    first = k + 1 + (words[k + 1].text in DETERMINERS)
    end = _open_end(words, first)
    noun = next((i for i in range(first, end) if words[i].text not in looks), end)
    if words[k].text != "or" or words[k - 1].text not in looks or not first < noun < end:
        return None
    if {words[k - 1].text, words[noun - 2].text} <= lexicon.shades and noun - 2 > k:
        noun -= 1  # dark or light blue
    start = next(i for i in range(k, -1, -1) if not i or words[i - 1].text not in looks)
    owned = start > 0 and first == k + 1 and _is_owner(words[start - 1])
    mine = words[start - 1 : start] if owned else []
    return [*words[:k], *words[noun:end], words[k], *mine, *words[k + 1 :]]


def _looking_each(words: list[Word], k: int, lexicon: Lexicon) -> list[Word] | None:
    """Spread the red and pink cups: a red cup and a pink one; a red and white cup is of both.

    Black and white are most often said of one thing, and so are the looks of what is worn.
    """
    looks = lexicon.attributes.keys() | lexicon.shades
    if words[k].text != "and" or words[k + 1].text not in looks:
        return None
    before = {words[k - 1].text, words[k + 1].text}
    end = _open_end(words, k + 1)
    noun = next((i for i in range(k + 1, end) if words[i].text not in looks), end)
    start = next(i for i in range(k, -1, -1) if not i or words[i - 1].text not in looks)
    many = noun < end and singular(words[end - 1].text) != words[end - 1].text
    if start == k or not many or before == _ONE_LOOK or words[start - 1].text not in _THE:
        return None
    if _WORN in lexicon.wider(singular(words[end - 1].text)):
        return None
    return [*words[:k], *words[noun:end], *words[k:]]


def _is_owner(word: Word) -> bool:
    return word.text in OWNERS or (word.text.endswith("'s") and len(word.text) > 2)


def _open_end(words: list[Word], start: int) -> int:
    """Return where the open words of a noun phrase at `start` end."""
    ends = (i for i in range(start, len(words)) if not is_open(words[i].text) or breaks(words, i))
    return next(ends, len(words))


def _relation_at(words: list[Word], k: int) -> int:
    """Return how many words the longest relation at `k` takes, 0 for none."""
    for parts, terminal in phrases().by_first.get(words[k].text, ()):
        if terminal.startswith("REL ") and [w.text for w in words[k : k + len(parts)]] == [*parts]:
            return len(parts)
    return 0


def _relation_ends(words: list[Word], k: int) -> bool:
    """Whether the words right before `k` are a relation."""
    return any(_relation_at(words, j) == k - j for j in range(max(1, k - 4), k))
