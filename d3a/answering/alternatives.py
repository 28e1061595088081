"""What will do as well, and what is left out: a pink cup or a red one, a red thing but no cup."""

from __future__ import annotations

from dataclasses import replace
from math import prod

from d3a.answering.match import Candidate
from d3a.answering.moments import Found
from d3a.answering.run import Run
from d3a.answering.steps import FindObjects, LeaveOut, TakeIn
from grammar.forms import ObjectTerm

RATHER = 0.5
"""What is likelier than this to be what is left out is left out."""


def take_in(run: Run, step: TakeIn) -> None:
    """Count what was found for each of the others as found for the variable.

    Of an object that several may mean the better one counts, and none that is doubtful before one
    that is not; what is refused as all of them is, and may be one of them where it may be any.
    """
    table = run.found[step.var]
    for other in [run.found.pop(name) for name in step.others]:
        for name, candidate in other.candidates.items():
            doubtful = name in other.doubtful
            own = table.candidates.get(name)
            known = None if own is None else (name not in table.doubtful, _worth(own))
            if known is None or known < (not doubtful, _worth(candidate)):
                table.candidates[name] = candidate
                table.doubtful = table.doubtful | {name} if doubtful else table.doubtful - {name}
        table.known = table.known or other.known
        table.refused += other.refused
    table.candidates = {name: table.candidates[name] for name in table.ids}
    table.refused.sort(key=lambda c: (bool(c.attributes), _worth(c)))  # of two the later counts
    refused = {c.record.object_id: c for c in table.refused}
    table.refused = [c for name, c in refused.items() if name not in table.candidates]


def leave_out(run: Run, step: LeaveOut) -> None:
    """Drop what is rather one of the others, and doubt the rest by how likely it is one.

    An other that cannot be told, as nobody knows the word, the look or whose it is, is not judged.
    """
    table = run.found[step.var]
    others = run.term(step.var).other_than
    for name, term in zip(step.others, others, strict=True):
        other = run.found.pop(name)
        if not other.known or other.unjudged or not _is_theirs(run, name, other):
            run.leave_out(f"not {_said(term)}")
            continue
        told = f"not {_said(term)}"
        table.candidates = {
            own: replace(candidate, attributes={**candidate.attributes, told: 1 - p})
            for own, candidate in table.candidates.items()
            if (p := _likely(other.candidates.get(own))) <= RATHER
        }


def _is_theirs(run: Run, var: str, found: Found) -> bool:
    """Whether the owner that is asked for, if any is, was taught of something that was found."""
    owner = next(s.owner for s in run.steps if isinstance(s, FindObjects) and s.var == var)
    candidates = found.candidates.values()
    return owner is None or any(n.owner == owner for c in candidates for n in c.record.names)


def _likely(candidate: Candidate | None) -> float:
    return 0.0 if candidate is None else min(1.0, _worth(candidate))


def _worth(candidate: Candidate) -> float:
    return candidate.match * prod(candidate.attributes.values())


def _said(term: ObjectTerm) -> str:
    whose = {None: "", "me": "my", "you": "your"}.get(term.owner, f"{term.owner}'s")
    return " ".join((*([whose] if whose else ()), *term.attributes, term.word))
