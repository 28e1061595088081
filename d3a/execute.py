"""Walk a plan over a store: one native query a step, joins and scores in numpy above it.

`execute` gives the answer without its sentence, which is the assistant's. What a store cannot
judge is left out of the search, lowers the score and is told; it never turns a find into a no.
"""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime
from time import perf_counter

from d3a.answer import Answer
from d3a.answering.attributes import judged
from d3a.answering.bounded import (
    find_bounded,
    find_joined,
    finds_stays_late,
    joins_late,
    slice_of,
)
from d3a.answering.conclude import conclude
from d3a.answering.facts import Facts
from d3a.answering.lookalikes import later_names
from d3a.answering.many import filter_place, find_many, spans_asked
from d3a.answering.match import (
    EXACT,
    Candidate,
    Lexicon,
    in_room,
    is_by_name,
    rungs,
    said_alone,
    unheard,
)
from d3a.answering.miscalled import without_miscalled
from d3a.answering.moments import Found
from d3a.answering.places import newest_look, probability_inside
from d3a.answering.presence import keep_present
from d3a.answering.run import Run, milliseconds
from d3a.answering.unfound import explain_empty
from d3a.parameters import Parameters
from d3a.plan import (
    Cover,
    DropGone,
    ExplainEmpty,
    FilterPlace,
    FindEdge,
    FindLandmarks,
    FindLaterNames,
    FindNow,
    FindObjects,
    FindSightings,
    FindStays,
    JudgeAttributes,
    KeepInRoom,
    KeepPresent,
    Measure,
    Plan,
    Rank,
    Step,
    Unite,
    numbers_unjudged,
)
from d3a.rank import rank
from d3a.store.base import Region, Store
from grammar.forms import ANYTHING, VARIABLES


def execute(
    plan: Plan,
    store: Store,
    lexicon: Lexicon,
    *,
    now: datetime,
    limit: int,
    parameters: Parameters,
    facts: Facts | None = None,
) -> Answer:
    """Return the answer of a plan, without its sentence.

    now: aware; its zone is that of the answer's times. What was seen after it is as if it had not
    been. limit: most keyframes. facts: where the caller has read of the store already. Raises
    StoreError.
    """
    facts = (facts or Facts(store)).as_of(now)
    run = Run(plan.query, facts.store, lexicon, now, parameters, facts, plan.steps)
    run.limit = limit
    for term in numbers_unjudged(plan.query):
        run.leave_out(f"{'at most' if term.bound == 'most' else term.bound} {term.quantity}")
    started = perf_counter()
    ranking_ms = 0.0
    for step in plan.steps:
        before = perf_counter()
        _take(run, step)
        if isinstance(step, Rank | Measure):
            ranking_ms += (perf_counter() - before) * 1000
    answer = conclude(run, limit)
    total_ms = (perf_counter() - started) * 1000
    answer.elapsed_ms.update(retrieve=total_ms - ranking_ms, rank=ranking_ms, total=total_ms)
    return answer


def _take(run: Run, step: Step) -> None:
    match step:
        case FindObjects():
            _find_objects(run, step)
        case JudgeAttributes():
            _judge(run, step)
        case FindSightings():
            _find_sightings(run, step)
        case FindEdge():
            _find_edge(run, step)
        case FindStays():
            _find_stays(run, step)
        case KeepInRoom():
            _keep_in_room(run, step)
        case DropGone():
            _drop_gone(run, step)
        case FilterPlace():
            filter_place(run, step)
        case Unite():
            run.leave_out(run.relation_words(step, [run.term(var) for var in step.vars[1:]]))
        case FindNow():
            _find_now(run, step)
        case KeepPresent():
            keep_present(run, step)
        case Measure():
            pass  # `conclude` counts what is left, once it is known to be something
        case Rank():
            _rank(run, step)
        case FindLaterNames():
            _find_later_names(run, step)
        case FindLandmarks():
            run.find_landmarks()
        case Cover():
            _cover(run, step)
        case ExplainEmpty():
            explain_empty(run, step)
        case _:
            from d3a.answering.seldom import take  # a simple question does without

            take(run, step)


def _find_objects(run: Run, step: FindObjects) -> None:
    looks = any(isinstance(s, JudgeAttributes) and s.var == step.var for s in run.steps)
    found, known = _candidates(run, step, looks=looks)
    split = in_room(step.word, [region.name for region in run.facts.regions()])
    if split is not None and step.precision is None:
        room, noun = split
        asked = replace(step, category=run.lexicon.canonical(noun), word=noun)
        within, known_within = _candidates(run, asked, looks=looks)
        region = run.region(room)
        assert region is not None
        run.plain[step.var] = {c.record.object_id: c for c in found}
        best = dict(run.plain[step.var])
        for candidate in within:
            other = best.get(candidate.record.object_id)
            if other is None or other.match < candidate.match:
                best[candidate.record.object_id] = candidate
        merged, known = [best[name] for name in sorted(best)], known or known_within
        if not {"/", "-"}.isdisjoint(step.var) or run.term(step.var).or_else:
            found = _in_region(run, region, merged) or found
        else:
            run.rooms[step.var], found = region, merged
    elif step.category != ANYTHING:
        worth, _ = run.facts.rungs(step, run.lexicon)
        if words := unheard(step, found, worth, run.lexicon):
            run.leave_out(words)
    found = _not_theirs(run, step, found)
    table = Found({c.record.object_id: c for c in found})
    table.known = known
    run.found[step.var] = table
    if step.var == VARIABLES[0] and not step.among and is_by_name(step, found):
        run.named_alone = tuple(table.ids)
    listed = run.query.ask in ("what", "count") and step.var == VARIABLES[0]
    one = not listed and step.category != ANYTHING
    told = step.owner in ("me", "you") and one
    left_out = "-" in step.var  # whose they are is said of what is left out, see `leave_out`
    if step.owner is not None and found and not told and not left_out:
        mine = any(n.owner == step.owner for c in found for n in c.record.names)
        if not mine:
            run.leave_out(said_alone(step.owner))


def _in_region(run: Run, region: Region, found: list[Candidate]) -> list[Candidate]:
    """Return what was ever in a room: the table of the kitchen, where the desk will do as well."""
    stays = list(run.facts.stays([c.record.object_id for c in found]).values())
    inside = probability_inside(region, stays)
    held = {stay.object_id for stay, p in zip(stays, inside, strict=True) if p >= 0.5}
    return [candidate for candidate in found if candidate.record.object_id in held]


def _not_theirs(run: Run, step: FindObjects, found: list[Candidate]) -> list[Candidate]:
    """Leave out what is taught to be theirs; not judged where nothing is."""
    if step.not_owner is None or not found:
        return found
    kept = [c for c in found if all(n.owner != step.not_owner for n in c.record.names)]
    if len(kept) == len(found):
        run.leave_out(f"not {said_alone(step.not_owner)}")
    return kept


def _candidates(run: Run, step: FindObjects, *, looks: bool) -> tuple[list[Candidate], bool]:
    """Return what the noun may mean, and whether it is a word of the store or its detectors.

    looks: with the embeddings, that attributes are judged by.
    """
    if step.among:
        return [Candidate(r, EXACT) for r in run.store.objects(ids=step.among, votes=True)], True
    worth, classes = run.facts.rungs(step, run.lexicon)
    known = bool(worth) or bool(classes) or step.precision == "perfect"  # asks for no category
    if step.votes:  # a word may be nobody's category and still have had some votes
        worth = {**rungs(step, (step.category, step.word), run.lexicon), **classes, **worth}
    if step.category == ANYTHING or step.precision == "any":
        records = run.facts.objects(None, embeddings=looks)
    else:
        records = run.facts.objects(list(worth), embeddings=looks) if worth else []
        taught = run.named(step)
        ids = {record.object_id for record in records}
        records = [*records, *(record for record in taught if record.object_id not in ids)]
    records = run.not_denied(step, records)
    found = run.facts.candidates(step, records, worth, run.parameters.confusion)
    return found, known or bool(found)


def _keep_in_room(run: Run, step: KeepInRoom) -> None:
    """Keep what lies in the room that the noun names; where nothing does, what is called so."""
    region, table = run.rooms.get(step.var), run.found[step.var]
    if region is None:
        return
    stays = sorted(table.stays.values(), key=lambda stay: stay.key)
    inside = probability_inside(region, stays)
    held = {stay.key for stay, p in zip(stays, inside, strict=True) if p >= 0.5}
    if not held:
        plain = run.plain[step.var]
        table.candidates = {name: plain[name] for name in table.candidates if name in plain}
    table.sightings = [
        s
        for s in table.sightings
        if s.object_id in table.candidates and (not held or s.stay in held)
    ]
    if held:
        kept = {name for name, _ in held}
        table.candidates = {n: c for n, c in table.candidates.items() if n in kept}
    table.stays = {key: stay for key, stay in table.stays.items() if key[0] in table.candidates}


def _judge(run: Run, step: JudgeAttributes) -> None:
    table = run.found[step.var]
    if not table.candidates:
        return
    verdict = judged(step, list(table.candidates.values()), run.facts.looks, run.lexicon)
    for words in verdict.unjudged if "-" not in step.var else ():  # it is said of what is left out
        run.leave_out(words)
    table.unjudged = bool(verdict.unjudged)
    table.refused = list(verdict.refused)
    table.candidates, table.doubtful = verdict.kept, verdict.doubtful


def _find_sightings(run: Run, step: FindSightings) -> None:
    table = run.found[step.var]
    if not table.candidates:
        return
    if step.select is not None and step.var not in run.rooms:
        find_bounded(run, step)
    elif joins_late(run):
        run.late.add(step.var)
        spans_asked(run, step.var, *slice_of(run, step.var))  # where it is asked for can be judged
    elif not find_many(run, step):
        find_joined(run, step)


def _find_edge(run: Run, step: FindEdge) -> None:
    table = run.found[step.var]
    if not table.candidates:
        return
    at = milliseconds(step.at)
    if step.edge == "last":
        found = run.store.edges(table.ids, "last", before_ms=at)
    else:
        found = run.store.edges(table.ids, "first", after_ms=at)
    known = {(s.stay, s.start_ms) for s in table.sightings}
    table.sightings += [s for s in found if (s.stay, s.start_ms) not in known]


def _find_stays(run: Run, step: FindStays) -> None:
    table = run.found[step.var]
    if table.sightings and not finds_stays_late(run):
        table.stays = run.facts.stays_of(table.sightings, whole=run.needs_stays(step.var))


def _drop_gone(run: Run, step: DropGone) -> None:
    at = milliseconds(step.at)
    table = run.found[step.var]
    for sighting in list(table.sightings):
        stay = table.stays.get(sighting.stay)
        absent = stay.last_absent_ms if stay is not None else None
        if absent is not None and at is not None and sighting.end_ms < absent <= at:
            table.sightings.remove(sighting)
            table.gone.append(sighting)


def _rank(run: Run, step: Rank) -> None:
    run.rank_step = step
    moments = [m for var in step.vars for m in run.answering(var)]
    if any(isinstance(one, JudgeAttributes) and one.doubts for one in run.steps):
        moments = without_miscalled(run, moments)
    moments = run.without_mere_doubts(moments)
    # of more than are told the newest are: when it was last seen so is said beside their number
    is_number = run.query.ask in ("how_often", "how_long") and len(moments) > run.limit
    run.ranked = rank(
        moments,
        "last" if is_number and step.select == "all" else step.select,
        spread=step.spread,
        unjudged=len(run.unjudged),
        at_ms=milliseconds(step.at),
        told=run.limit,
        together_m=run.parameters.together_m,
    )


def _find_later_names(run: Run, step: FindLaterNames) -> None:
    if not run.ranked or run.rank_step is None:
        return
    found, entry = run.found[step.var], run.ranked[0].moment.figure
    before = len(found.sightings)
    later_names(run.facts, entry, found, run.parameters)
    if len(found.sightings) > before:
        _rank(run, run.rank_step)


def _find_now(run: Run, step: FindNow) -> None:
    """Find the newest sighting of each object of the moments, in place of these."""
    table = run.found[step.var]
    ids = {moment.figure.sighting.object_id for moment in run.moments or ()}
    if run.moments is None or not ids:
        return
    table.candidates = {name: c for name, c in table.candidates.items() if name in ids}
    table.sightings = run.store.edges(table.ids, "last")
    table.stays |= run.facts.stays_of(table.sightings)
    run.moments = None


def _cover(run: Run, step: Cover) -> None:
    region = run.region(step.place) if step.place is not None else None
    if region is None:
        run.last_looked_ms = run.facts.last_view_ms()
    else:
        run.last_looked_ms = newest_look(run.store, region, run.facts.last_view_ms())
