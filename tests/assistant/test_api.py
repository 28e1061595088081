"""The Python API: what it answers, how light it is, and that its documentation is true."""

from __future__ import annotations

import doctest
import re
import subprocess
import sys
from collections.abc import Callable
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest

import assistant.api
import d3a
from assistant.asking import ask
from assistant.home.folder import recording_folder
from d3a.ingest import ingest
from d3a.parameters import DEFAULT
from d3a.readers.opening import open_source
from d3a.store import open_store
from grammar import OutOfScope
from grammar.forms import FormalQuery

ROOT = Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"^```python\n(>>> .*?)^```$", re.MULTILINE | re.DOTALL)


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The demo home as `home.db`."""
    path = str(tmp_path_factory.mktemp("api") / "home.db")
    with closing(open_store(path)) as store:
        ingest(open_source(recording_folder()), store, DEFAULT)
    return path


def run(text: str, name: str, names: dict[str, object]) -> None:
    """Run the examples of a text; fail with what doctest says."""
    said: list[str] = []
    examples = doctest.DocTestParser().get_doctest(text, names, name, name, 0)
    assert examples.examples, "a page without an example proves nothing"
    result = doctest.DocTestRunner().run(examples, out=said.append)
    assert result.failed == 0, "".join(said)


def test_the_module_s_own_example_is_true(home: str) -> None:
    run(assistant.api.__doc__ or "", "assistant.api", {"home": home})


def test_the_examples_of_the_readme_are_true(home: str, monkeypatch: pytest.MonkeyPatch) -> None:
    blocks = BLOCK.findall((ROOT / "README.md").read_text(encoding="utf-8"))
    if not blocks:
        pytest.skip("README shows no Python example yet")
    monkeypatch.chdir(Path(home).parent)
    run("\n".join(blocks), "README.md", {})


def test_words_and_formal_query_give_the_answer_of_the_command(home: str) -> None:
    text = "Where is the red cup?"
    with d3a.open(home) as memory:
        now = memory.now()
        said = memory.ask(text)
        asked = ask(memory.store, text, now=now)
        plain = [{**a.to_json(), "elapsed_ms": None} for a in (said, asked)]
        assert plain[0] == plain[1]
        assert said.status == "found"
        query = memory.query(text)
        assert memory.ask(query).keyframes == said.keyframes
        assert memory.plan(query) == memory.plan(text)
        told = memory.explain(query)
        assert told.plan == memory.plan(text)
        assert [native.text for native in told.native] == [
            native.text for native in memory.explain(text).native
        ]


def test_limit_precision_and_now_are_those_of_ask(home: str) -> None:
    with d3a.open(home) as memory:
        assert len(memory.ask("Where was the cup?", limit=1).keyframes) == 1
        assert memory.ask("Where is the mug?", precision="perfect").status != "found"
        assert memory.ask("Where is the mug?", precision="category").status == "found"
        before = memory.ask("Where was the cup yesterday?", now="2026-05-13T20:00+01:00")
        assert {k.start.date().isoformat() for k in before.keyframes} == {"2026-05-12"}
        assert memory.now("last").isoformat(timespec="seconds") == "2026-05-14T19:50:46+01:00"
        assert memory.now(datetime(2026, 5, 14, tzinfo=UTC)).hour == 1, "in the home's zone"
        with pytest.raises(d3a.BadInput, match="precision 'sharp'"):
            memory.ask("Where is the cup?", precision="sharp")
        with pytest.raises(d3a.BadInput, match="ISO text"):
            memory.ask("Where is the cup?", now="soon")


def test_what_is_not_understood_is_an_answer_and_only_query_raises(home: str) -> None:
    with d3a.open(home) as memory:
        assert memory.ask("blorp the fnord").status == "not_understood"
        with pytest.raises(d3a.BadQuestion):
            memory.query("blorp the fnord")
        cups = memory.objects(categories=["cup"])
        assert cups
        assert {thing.category for thing in cups} == {"cup"}
        image = memory.ask("Where is the cup?").keyframes[0].image
        assert image is not None
        picture = memory.keyframe(image)
        assert picture is not None
        assert picture.jpeg.startswith(b"\xff\xd8")
        assert repr(memory).endswith("home.db>")


BAD: dict[str, Callable[[Any], object]] = {
    "a question of the wrong kind": lambda m: m.ask(None),
    "a number": lambda m: m.query(7),
    "an empty record": lambda m: m.ask({}),
    "a record with an unknown form": lambda m: m.ask({**m.query("cup?").to_json(), "form": "Q9"}),
    "a record with a wrong time": lambda m: m.plan(
        {**m.query("cup?").to_json(), "time": {"start": "soon", "end": None}}
    ),
    "a limit of nothing": lambda m: m.ask("cup?", limit=0),
    "a limit below": lambda m: m.ask("cup?", limit=-3),
    "a limit of the wrong kind": lambda m: m.ask("cup?", limit="many"),
    "a precision": lambda m: m.ask("cup?", precision="foo"),
    "a now": lambda m: m.ask("cup?", now="nonsense"),
    "a now of the wrong kind": lambda m: m.explain("cup?", now=5),
    "a now beyond time": lambda m: m.ask("cup?", now="0001-01-01T00:00+10:00"),
    "categories": lambda m: m.objects(categories=5),
    "names": lambda m: m.objects(names=[1]),
    "an image": lambda m: m.keyframe(None),
    "a question to query": lambda m: m.query("why"),
    "a question to plan": lambda m: m.plan("blorp the fnord"),
    "a question to explain": lambda m: m.explain("why"),
}


@pytest.mark.parametrize("what", BAD)
def test_bad_input_is_refused_by_an_error_of_d3a(home: str, what: str) -> None:
    with d3a.open(home) as memory, pytest.raises(d3a.D3AError, match=r"\w+ \w+"):
        BAD[what](memory)


def test_a_question_without_a_query_tells_the_grammar_s_reason(home: str) -> None:
    with d3a.open(home) as memory, pytest.raises(d3a.BadQuestion) as refused:
        memory.query("Why did I leave my keys?")
    assert isinstance(refused.value.error, OutOfScope)
    assert str(refused.value) == str(refused.value.error)


def test_a_record_is_asked_as_the_query_it_is_of(home: str) -> None:
    with d3a.open(home) as memory:
        query = memory.query("Where was the red cup this morning?")
        record = query.to_json()
        assert memory.query(record) == FormalQuery.from_json(record)
        assert memory.ask(record).keyframes == memory.ask(query).keyframes
        assert memory.plan(record) == memory.plan(query)
        assert memory.explain(record).query.formal == query.formal


def test_explain_tells_the_answer_of_ask_at_its_precision(home: str) -> None:
    with d3a.open(home) as memory:
        for precision in (None, "category", "perfect"):
            told = memory.explain("Where is the mug?", precision=precision)
            said = memory.ask("Where is the mug?", precision=precision)
            assert (told.answer.status, told.answer.answer) == (said.status, said.answer)
            assert said.answer in told.to_text()
            assert told.to_json()["answer"] == said.answer


def test_explain_tells_of_as_much_as_ask_where_all_is_asked_for(home: str) -> None:
    with d3a.open(home) as memory:
        told = memory.explain("Where is everything?").answer
        assert told.answer == memory.ask("Where is everything?").answer
        assert told.count > 50


def test_one_category_or_name_is_taken_as_one(home: str) -> None:
    with d3a.open(home) as memory:
        assert memory.objects(categories="cup") == memory.objects(categories=["cup"]) != []
        assert memory.objects(names="cup") == memory.objects(names=["cup"])


def test_a_closed_or_missing_store_is_told(home: str, tmp_path: Path) -> None:
    with pytest.raises(d3a.StoreUnreachable, match="does not exist"):
        d3a.open(tmp_path / "none.db")
    memory = d3a.open(home)
    memory.close()
    with pytest.raises(d3a.StoreError):
        memory.objects()


def test_public_names_load_when_used_and_others_do_not_exist() -> None:
    code = (
        "import sys, d3a; before = set(sys.modules); d3a.D3AError; "
        "print('assistant' in before, 'numpy' in before, 'lark' in sys.modules, "
        "set(d3a.__all__) <= set(dir(d3a)), hasattr(d3a, 'nothing'))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["False", "False", "False", "True", "False"]
    assert all(getattr(d3a, name) is not None for name in d3a.__all__)
