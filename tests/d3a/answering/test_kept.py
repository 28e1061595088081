"""What is kept between questions: no more than there is room for, the last asked for longest."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from d3a.answering.kept import Kept


def test_what_was_not_asked_for_longest_goes_first() -> None:
    kept: Kept[str, int] = Kept(3)
    for name, number in (("a", 1), ("b", 2), ("c", 3)):
        kept.put(name, number, 1)
    assert kept.get("a", None) == 1  # asked for: b is the oldest now
    kept.put("d", 4, 1)
    assert [kept.get(name, None) for name in "abcd"] == [1, None, 3, 4]


def test_several_are_asked_for_as_one_by_one() -> None:
    kept: Kept[str, int] = Kept(3)
    for name, number in (("a", 1), ("b", 2), ("c", 3)):
        kept.put(name, number, 1)
    assert kept.several(["b", "x", "a"]) == {"b": 2, "a": 1}
    kept.put("d", 4, 1)  # c was not asked for longest
    assert kept.several("abcd") == {"a": 1, "b": 2, "d": 4}


def test_what_is_larger_than_the_room_drives_nothing_out() -> None:
    kept: Kept[str, int] = Kept(3)
    kept.put("small", 1, 2)
    kept.put("large", 2, 4)
    assert (kept.get("small", None), kept.get("large", None)) == (1, None)
    kept.put("small", 3, 4)  # it has grown out of the room
    assert kept.get("small", None) is None
    kept.put("whole", 4, 3)
    assert kept.get("whole", None) == 4


@given(st.lists(st.tuples(st.integers(0, 5), st.integers(0, 9)), max_size=60), st.integers(0, 20))
def test_it_never_holds_more_than_there_is_room_for(puts: list[tuple[int, int]], most: int) -> None:
    kept: Kept[int, int] = Kept(most)
    for key, size in puts:
        kept.put(key, size, size)
        found = [kept.get(name, -1) for name in range(6)]
        assert sum(size for size in found if size >= 0) <= most
        assert kept.get(key, -1) == (size if size <= most else -1)
