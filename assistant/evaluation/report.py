"""One self-contained HTML page: tables, plots, and what must be known to read them."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from assistant.evaluation import paper
from assistant.evaluation.tables import Table

STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 78rem; padding: 0 1rem;
       color: #1b1b1b; background: #fff; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin-top: 2.2rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .82rem; }
th, td { padding: .18rem .55rem; border-bottom: 1px solid #ddd; text-align: right; }
th:first-child, td:first-child { text-align: left; } thead th { border-bottom: 2px solid #888; }
.wide { overflow-x: auto; } .note { color: #555; font-size: .85rem; max-width: 60rem; }
.paper { color: #777; } svg { max-width: 100%; height: auto; }
"""


def page(title: str, lead: Sequence[str], sections: Sequence[tuple[Table, str | None]]) -> str:
    """Return the page. lead: paragraphs; sections: a table and its plot as SVG, if it has one."""
    parts = [
        "<!doctype html>",
        '<html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{escape(title)}</title><style>{STYLE}</style></head><body>",
        f"<h1>{escape(title)}</h1>",
        *(f"<p>{escape(paragraph)}</p>" for paragraph in lead),
    ]
    for table, plot in sections:
        parts.append(_section(table, plot))
    parts.append(_contradictions())
    parts.append("</body></html>")
    return "\n".join(parts) + "\n"


def _section(table: Table, plot: str | None) -> str:
    theirs = {k for k, name in enumerate(table.head) if name.startswith("paper")}
    paper_class = ' class="paper"'

    def row(cells: Sequence[str], tag: str) -> str:
        shown = (
            f"<{tag}{paper_class if k in theirs else ''}>{escape(cell)}</{tag}>"
            for k, cell in enumerate(cells)
        )
        return f"<tr>{''.join(shown)}</tr>"

    body = "\n".join(row(cells, "td") for cells in table.rows)
    notes = "".join(f'<p class="note">{escape(note)}</p>' for note in table.notes)
    figure = f'<div class="wide">{plot}</div>' if plot else ""
    return (
        f"<h2>{escape(table.title)}</h2>{figure}"
        f'<div class="wide"><table><thead>{row(table.head, "th")}</thead>'
        f"<tbody>{body}</tbody></table></div>{notes}"
    )


def _contradictions() -> str:
    rows = "".join(f"<li>{escape(line)}</li>" for line in paper.contradictions())
    source = escape(paper.record()["source"])
    return (
        f"<h2>{escape(paper.CONTRADICTIONS)}</h2>"
        f'<ul>{rows}</ul><p class="note">Figures typed from {source}.</p>'
    )
