"""The demo home: ingest what ships with the product into a store of its own, once."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import d3a
from assistant.config import STORE_SCHEME, Settings, user_cache
from assistant.session import Session
from assistant.wording import answer_lines
from d3a.model import Json
from d3a.parameters import DEFAULT, Parameters

QUESTIONS = (
    "Where are my keys?",
    "When were the cup and the bowl seen together yesterday evening?",
    "Where was my handbag yesterday evening?",
    "Did you see an umbrella?",
    "What moved today?",
)
"""The title's own, a Q2, a Q3, an honest no, and a carer's."""
TOUR = (*QUESTIONS[:3], "And this morning?", QUESTIONS[3])
"""What the demo asks by itself: a follow-up needs the question before it."""
TOUR_ROWS = 3


def demo_store(settings: Settings, tell: Callable[[str], None]) -> str:
    """Return the URI of the filled demo store, filling it where it is not there yet.

    The file's name holds a digest of the recording, the parameters and the program that fills
    it, so that a new release fills anew. It is filled beside its place and then renamed: an
    interrupted run leaves nothing that looks whole. Raises StoreError, BadInput and SettingsError.
    """
    from assistant.home.folder import recording_folder
    from d3a.ingest import ingest
    from d3a.readers.opening import open_source
    from d3a.store import open_store

    folder = recording_folder()
    path = user_cache() / f"demo-{_digest(folder, DEFAULT)}.db"
    if not path.exists():
        if not settings.quiet:
            tell("Filling the demo home's memory, once ...")
        draft = path.with_name(f"{path.stem}-{os.getpid()}.draft")
        store = open_store(STORE_SCHEME + str(draft))
        try:
            ingest(open_source(folder), store, DEFAULT)
        finally:
            store.close()
        draft.replace(path)
    _remove_others(path)
    return STORE_SCHEME + str(path)


def _digest(folder: Path, parameters: Parameters) -> str:
    """Return what tells one filling from another: the recording, the parameters, the program."""
    digest = hashlib.sha256(repr(parameters).encode())
    for name in ("recording.json", "frames.jsonl", "detections.jsonl"):
        digest.update((folder / name).read_bytes())
    program = Path(d3a.__file__).parent
    for source in sorted(program.rglob("*.py")):
        digest.update(f"{source.relative_to(program)} {source.stat().st_size}\n".encode())
    return digest.hexdigest()[:12]


def _remove_others(path: Path) -> None:
    """Remove the stores of earlier releases, and drafts whose program is gone."""
    for other in path.parent.glob("demo-*"):
        owner = re.fullmatch(r"demo-\w+-(\d+)\.draft.*", other.name)
        if owner is not None and _is_running(int(owner[1])):
            continue
        if not other.name.startswith(path.name):
            other.unlink(missing_ok=True)


def _is_running(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:  # it runs, as somebody else's
        return True
    return process != os.getpid()


def tour_records(session: Session) -> Iterator[Json]:
    """Yield the answers to the demo's questions as records."""
    for question in TOUR:
        yield session.safely(question).to_json()


def tour_lines(session: Session) -> Iterator[str]:
    """Yield the demo's questions with their answers, for a README and for a machine."""
    for question in TOUR:
        yield f"You: {question}"
        yield "\n".join(answer_lines(session.safely(question), session.now(), rows=TOUR_ROWS))
        yield ""
