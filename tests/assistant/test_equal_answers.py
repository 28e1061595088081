"""Every store gives the same answers: drawn homes, drawn formal queries, compared exactly.

D3A_DRAWN says of how many homes; `python -m tests.bench.bench_equal` runs many of them.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from contextlib import closing
from typing import Any

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from assistant.asking import ask_query
from assistant.lexicon import VocabularyLexicon
from d3a.answering import bounded, facts, late, many
from d3a.answering.facts import Facts
from d3a.execute import execute
from d3a.plan import plan
from d3a.store.base import Store
from grammar.forms import FormalQuery
from tests.worlds import drawn
from tests.worlds.made import NOW, Home
from tests.worlds.oracle import OracleStore

DRAWN = int(os.environ.get("D3A_DRAWN", "12"))
QUERIES = 6
SETTINGS = settings(
    max_examples=DRAWN,
    deadline=None,
    phases=[Phase.explicit, Phase.reuse, Phase.generate],  # a store a try: shrinking takes minutes
    suppress_health_check=list(HealthCheck),
)


def answers(store: Store, queries: Sequence[FormalQuery], limit: int) -> list[Any]:
    """Every answer as its record, sentence and order included, without its times."""
    told = []
    for query in queries:
        said = ask_query(store, query, now=NOW).to_json()
        steps = plan(query)
        assert steps == plan(FormalQuery.from_json(query.to_json()))
        parameters = Facts(store).parameters()
        cut = execute(
            steps, store, VocabularyLexicon(), now=NOW, limit=limit, parameters=parameters
        ).to_json()
        told.append([{k: v for k, v in one.items() if k != "elapsed_ms"} for one in (said, cut)])
    return told


@pytest.mark.parametrize("number", [DRAWN], ids=[f"{DRAWN} homes of {QUERIES} queries"])
@given(
    home=drawn.homes(),
    queries=st.lists(drawn.queries(), min_size=QUERIES, max_size=QUERIES),
    limit=st.integers(1, 3),
    joined=st.sampled_from([2, 10_000]),
    whole=st.sampled_from([1, 2_000]),
)
@SETTINGS
def test_drawn_queries_are_answered_as_over_the_oracle(
    make_store: Callable[[], Store],
    number: int,
    home: Home,
    queries: Sequence[FormalQuery],
    limit: int,
    joined: int,
    whole: int,
) -> None:
    with pytest.MonkeyPatch.context() as patch, closing(make_store()) as store:
        patch.setattr(bounded, "MOST_JOINED", joined)
        for module in (facts, late, many):
            patch.setattr(module, "MOST_WHOLE", whole)
        oracle = OracleStore()
        home.into(oracle)
        home.into(store)
        assert answers(store, queries, limit) == answers(oracle, queries, limit)
