"""`d3a chat`: the conversation, full screen or a line at a time."""

from __future__ import annotations

import difflib
import shutil
import sys
from datetime import datetime
from typing import TYPE_CHECKING

import click

from assistant.exits import ExitCode
from assistant.options import Failure, now_of, opened, settings_of, settings_options
from assistant.serving import PORT, serving_options
from assistant.serving import serve as serve_chat
from assistant.terminal import is_terminal, why_not_full_screen

if TYPE_CHECKING:
    from assistant.config import Settings
    from assistant.history import History
    from assistant.session import Session
    from assistant.ui.app import ChatApp
    from d3a.store.base import Store


@click.command("chat")
@click.option("--plain", is_flag=True, help="A line at a time, for screen readers and pipes.")
@serving_options
@settings_options
@click.pass_context
def command(
    context: click.Context,
    plain: bool = False,
    serve: bool = False,
    port: int = PORT,
    served: bool = False,
) -> None:
    """Open the chat over the store: ask, look at the pictures, see the places.

    Without a terminal that can show it, the conversation is held a line at a time.
    """
    settings = settings_of(context)
    with opened(settings) as store:
        if not serve:
            hold(session_of(settings, store), settings, plain=plain, served=served)
            return
    serve_chat("chat", settings, port)  # the store was there; each page opens it anew


def session_of(
    settings: Settings, store: Store, *, title: str = "", suggestions: tuple[str, ...] = ()
) -> Session:
    """Return a session that asks `store`; its clock runs on unless `now` was fixed."""
    from assistant.conversation import Conversation
    from assistant.newest_frame import newest_frame
    from assistant.session import Session

    opened_at, began = now_of(settings, store), settings.clock()
    given = settings.now is not None
    fixed = given or store.meta("now") is not None

    def now() -> datetime:
        return opened_at if fixed else opened_at + (settings.clock() - began)

    def asked_at() -> datetime:
        moment = now()  # the robot goes on seeing while one talks, by a clock of its own
        return moment if given else max(moment, newest_frame(store, moment))

    talk = Conversation(store, asked_at)
    sites = sorted({recording.site for recording in store.recordings() if recording.site})
    return Session(
        store=store,
        ask=talk.ask,
        alone=talk.alone,
        teaches=talk.teaches,
        explain=talk.explain,
        pointer=talk.pointer,
        now=now,
        title=title or ", ".join(sites) or "this home",
        suggestions=suggestions,
    )


def hold(
    session: Session, settings: Settings, *, plain: bool = False, served: bool = False
) -> None:
    """Hold the conversation: full screen where the terminal can, else line by line.

    served: a browser is the screen.
    """
    from assistant.config import user_state
    from assistant.history import History

    why_not = None if served else why_not_full_screen()
    history = History(user_state() / "questions.jsonl") if settings.history else History()
    if plain or why_not is not None:
        if not plain and not settings.quiet and is_terminal(sys.stderr):
            click.echo(f"d3a: {why_not}, so the chat is held line by line", err=True)
        hold_plain(session, settings, history)
        return
    from assistant.protocols import PIXELS, choose
    from assistant.ui.app import ChatApp
    from assistant.ui.hanging_up import end_when_closed

    chosen = choose(settings.images)
    if chosen.kind in PIXELS:
        from assistant.ui import pixels

        pixels.load(chosen.cell)
    app = ChatApp(
        session, history=history, pictures=chosen.kind, speak=settings.speak, keys=settings.keys
    )
    if settings.theme:
        wear(app, settings.theme)
    app.chat.typed = chosen.typed
    if not served:
        end_when_closed(sys.stdin)
    app.run()


def wear(app: ChatApp, theme: str) -> None:
    """Give the chat a theme by its name; a Failure that names the nearest where there is none."""
    themes = sorted(app.available_themes)
    if theme not in themes:
        near = difflib.get_close_matches(theme, themes, n=1, cutoff=0.4)
        hint = f"; nearest: {near[0]}" if near else ""
        raise Failure(f"theme {theme!r} is none of {', '.join(themes)}{hint}", ExitCode.USAGE)
    app.theme = theme


def hold_plain(session: Session, settings: Settings, history: History) -> None:
    """Hold the conversation line by line: with a person at the terminal, or with a pipe."""
    from assistant.lines import typed_lines
    from assistant.plain import PlainChat, talk, wrapped
    from assistant.session import known_words
    from assistant.speaking import Voice
    from d3a.model import D3AError

    def say(line: str) -> None:
        width = shutil.get_terminal_size().columns if is_terminal(sys.stdout) else 0
        click.echo(wrapped(line, width) if width else line)

    voice = Voice(settings.speak)
    if not is_terminal(sys.stdin):  # what a script asks is nobody's earlier question
        talk(PlainChat(session, say, voice=voice), sys.stdin)
        return
    chat = PlainChat(session, say, echoes=False, history=history, voice=voice)
    chat.welcome()
    try:
        words = known_words(session.store)
    except D3AError:  # said by the greeting; the talk goes on without completing words
        words = ()
    talk(chat, typed_lines(history, words, say))
