"""Take the steps that a simple question does not have, apart so that it need not load them."""

from __future__ import annotations

from typing import assert_never

from d3a.answering.alternatives import leave_out, take_in
from d3a.answering.changes import missing, moved, usual
from d3a.answering.often import often
from d3a.answering.relating import gather, relate_found
from d3a.answering.run import Run
from d3a.answering.steps import (
    FindStretches,
    Gather,
    KeepMissing,
    KeepMoved,
    KeepOften,
    KeepThen,
    KeepUsual,
    LeaveOut,
    Relate,
    TakeIn,
)
from d3a.answering.stretches import stretches
from d3a.answering.then import keep_then

Seldom = (
    TakeIn
    | LeaveOut
    | Relate
    | Gather
    | FindStretches
    | KeepMoved
    | KeepMissing
    | KeepOften
    | KeepThen
    | KeepUsual
)
"""The steps that `take` takes; `d3a.execute` takes the others."""


def take(run: Run, step: Seldom) -> None:
    """Take a step of a plan. Raises StoreError."""
    match step:
        case TakeIn():
            take_in(run, step)
        case LeaveOut():
            leave_out(run, step)
        case Relate():
            relate_found(run, step)
        case Gather():
            gather(run, step)
        case FindStretches():
            run.stretches = stretches(run, step)
        case KeepMoved():
            run.moments = [*(run.moments or ()), *moved(run, step)]
        case KeepMissing():
            run.moments = [*(run.moments or ()), *missing(run, step)]
        case KeepOften():
            run.moments = [*often(run, step)]
        case KeepThen():
            keep_then(run, step)
        case KeepUsual():
            run.moments = [*(run.moments or ()), *usual(run, step)]
        case _:
            assert_never(step)
