"""How a question was answered, for `d3a explain`: as a record and as text."""

from __future__ import annotations

from dataclasses import dataclass, field

from d3a.answer import Answer
from d3a.model import Json
from d3a.plan import Plan
from d3a.store.base import NativeQuery
from grammar.forms import FormalQuery


@dataclass(frozen=True, slots=True)
class Explanation:
    """How a question is answered: formal query, plan, the store's native queries, times."""

    query: FormalQuery
    plan: Plan
    native: tuple[NativeQuery, ...]
    answer: Answer
    elapsed_ms: dict[str, float] = field(default_factory=dict)

    def to_json(self) -> Json:
        """Return one record: query, plan, native queries with index, rows and ms, times."""
        return {
            "text": self.query.text,
            "query": self.query.to_json(),
            "plan": self.plan.to_json(),
            "native": [
                {
                    "query": native.text,
                    "index": native.index,
                    "rows": native.rows,
                    "elapsed_ms": round(native.elapsed_ms, 3),
                }
                for native in self.native
            ],
            "status": self.answer.status,
            "count": self.answer.count,
            "answer": self.answer.answer,
            "elapsed_ms": {name: round(ms, 3) for name, ms in self.elapsed_ms.items()},
        }

    def to_text(self) -> str:
        """Return the same for reading, a line a step and a line a native query."""
        lines = [f"query   {self.query.formal}", "plan"]
        lines += [f"  {number}. {line}" for number, line in enumerate(self.plan.lines(), 1)]
        lines.append("native queries")
        for native in self.native:
            index = native.index or "no index"
            lines.append(f"  {native.elapsed_ms:7.3f} ms  {native.rows:6d} rows  {index}")
            lines.append(f"      {native.text}")
        spent = ", ".join(f"{name} {ms:.2f}" for name, ms in self.elapsed_ms.items())
        lines.append(f"answer  {self.answer.status}, {self.answer.count} objects")
        lines.append(f"        {self.answer.answer}")
        lines.append(f"times   {spent} (ms)")
        return "\n".join(lines)
