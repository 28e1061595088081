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
th { vertical-align: bottom; } td { white-space: nowrap; } .words { text-align: left; }
thead th { border-bottom: 2px solid #888; } tr.begins td { border-top: 1.5px solid #aaa; }
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
    kinds = [_kind(table, k) for k in range(len(table.head))]

    def row(cells: Sequence[str], tag: str, begins: str = "") -> str:
        shown = (
            f"<{tag}{kind}>{escape(cell)}</{tag}>" for kind, cell in zip(kinds, cells, strict=True)
        )
        return f"<tr{begins}>{''.join(shown)}</tr>"

    body = "\n".join(
        row(cells, "td", begins) for cells, begins in zip(table.rows, _begins(table), strict=True)
    )
    notes = "".join(f'<p class="note">{escape(note)}</p>' for note in table.notes)
    figure = f'<div class="wide">{plot}</div>' if plot else ""
    return (
        f"<h2>{escape(table.title)}</h2>{figure}"
        f'<div class="wide"><table><thead>{row(table.head, "th")}</thead>'
        f"<tbody>{body}</tbody></table></div>{notes}"
    )


def _kind(table: Table, column: int) -> str:
    """Return a column's class: the paper's figures are grey, words stand on the left."""
    if table.head[column].startswith("paper"):
        return ' class="paper"'
    cells = "".join(row[column] for row in table.rows)
    is_words = column == 0 or any(map(str.isalpha, cells))
    return ' class="words"' if is_words else ""


def _begins(table: Table) -> list[str]:
    """Return the class of each row: a line where the first two cells are others than above."""
    keys = [row[:2] for row in table.rows]
    if len(set(keys)) == len(keys):  # no rows belong together
        return [""] * len(keys)
    above = [None, *keys[:-1]]
    return ["" if one == two else ' class="begins"' for one, two in zip(keys, above, strict=True)]


def _contradictions() -> str:
    rows = "".join(f"<li>{escape(line)}</li>" for line in paper.contradictions())
    source = escape(paper.record()["source"])
    return (
        f"<h2>{escape(paper.CONTRADICTIONS)}</h2>"
        f'<ul>{rows}</ul><p class="note">Figures typed from {source}.</p>'
    )
