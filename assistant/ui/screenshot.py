"""Draw the chat on the demo home as SVG files, for a README: `python -m assistant.ui.screenshot`.

The demo's clock stands still and no terminal takes part, so the same program draws the same
files on every machine.
"""

from __future__ import annotations

import asyncio
from dataclasses import replace
from pathlib import Path

import click

from assistant.session import Session
from assistant.ui.app import ChatApp
from assistant.ui.picture import PictureView

PATIENCE_S = 10.0


async def draw(session: Session, question: str, size: tuple[int, int]) -> str:
    """Return the screen after `question` was asked, its pictures drawn, as SVG."""
    timeless = replace(session, ask=lambda text: replace(session.safely(text), elapsed_ms={}))
    app = ChatApp(timeless)
    async with app.run_test(size=size) as pilot:
        await pilot.pause()
        app.ask(question)
        waited = 0.0
        while not _is_drawn(app) and waited < PATIENCE_S:
            await pilot.pause(0.05)
            waited += 0.05
        await pilot.pause(0.1)
        return app.export_screenshot(title="d3a")


def _is_drawn(app: ChatApp) -> bool:
    """Whether an answer stands there, and each of its pictures that has room for one."""
    if app.chat.shot is None:
        return False
    views = [view for view in app.chat.query(PictureView) if view.region.area > 0]
    return all(view.text for view in views)


@click.command()
@click.argument("folder", type=click.Path(file_okay=False, path_type=Path))
@click.option("--question", default="Where is the blue cup?", show_default=True)
def main(folder: Path, question: str) -> None:
    """Write chat-80x24.svg and chat-160x50.svg into FOLDER."""
    from assistant.cli import clock
    from assistant.commands.chat import session_of
    from assistant.config import Settings
    from assistant.demo import QUESTIONS, demo_store
    from d3a.store import open_store

    settings = Settings(clock=clock)
    store = open_store(demo_store(settings, lambda line: click.echo(line, err=True)), create=False)
    session = session_of(settings, store, title="the demo home", suggestions=QUESTIONS)
    folder.mkdir(parents=True, exist_ok=True)
    for size in ((80, 24), (160, 50)):
        path = folder / f"chat-{size[0]}x{size[1]}.svg"
        path.write_text(asyncio.run(draw(session, question, size)), encoding="utf-8")
        click.echo(str(path))
    store.close()


if __name__ == "__main__":
    main()
