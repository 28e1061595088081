"""The experiments on a small world: what they give, and that what they give is right."""

from __future__ import annotations

import json
import shutil
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from assistant.asking import ask
from assistant.evaluation import exp1, exp2, exp3, exp4, running, tables
from assistant.evaluation.asking_stores import FORCED, Asker, by_probability
from assistant.evaluation.commands import evaluate_command, parse_seeds, simulate_command
from assistant.evaluation.exp2 import Outcome
from assistant.evaluation.judging import Judge
from assistant.evaluation.methods import (
    D3A_D,
    D3A_P_EXACT,
    METHODS,
    NAIVE,
    NAIVE_PLUS,
    OURS,
    filled,
    teach,
)
from assistant.evaluation.questions import Question, draw
from assistant.evaluation.worlds import Recorded, Steps, World, recorded
from d3a.answer import Answer, RankedKeyframe
from d3a.metrics import CUT, best_ids
from d3a.model import BadInput
from d3a.readers.opening import open_source
from d3a.simulate import is_whole, simulate
from d3a.store.opening import open_store

HOURS = 0.5
SMALL = World(seed=3, hours=HOURS)


@pytest.fixture(scope="module")
def work(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("evaluation")


@pytest.fixture(scope="module")
def source(work: Path) -> Recorded:
    return recorded(SMALL, "nominal", work)


@pytest.fixture(scope="module")
def outcomes(work: Path) -> dict[str, Outcome]:
    steps = Steps(running.quiet, len(METHODS))
    return {o.method.key: o for o in exp2.run([SMALL], work, steps, count=8)}


def test_the_experiments_are_told_what_a_person_is_told(source: Recorded, work: Path) -> None:
    now = datetime.fromtimestamp(source.truth.span_ms[1] / 1000, source.zone)
    asked = draw(source.truth, source.zone, np.random.default_rng(4), count=4, negatives=2)
    told = 0
    with filled(OURS, source, work / "as-told") as run:
        teach(run.store, source.truth, run.assignments)
        asker = Asker(run, now)
        for question in asked:
            limit = CUT * max(1, len(question.targets))
            for level, text in question.texts.items():
                if level == "perfect":  # what could not be taught is no word there
                    continue
                person = ask(run.store, text, now=now, limit=limit, precision=FORCED[level])
                answer, _ = asker.ask(text, level)
                shown = [(k.object_id, k.frame, k.box, k.score) for k in answer.keyframes]
                assert shown == [(k.object_id, k.frame, k.box, k.score) for k in person.keyframes]
                told += len(shown)
    assert told > 100


def test_every_method_answers_at_every_level(outcomes: dict[str, Outcome]) -> None:
    assert set(outcomes) == {method.key for method in METHODS}
    for outcome in outcomes.values():
        assert len(outcome.cells) == 12
        assert all(cell.queries == 8 for cell in outcome.cells)
        assert all(0.0 <= cell.miss["strict"] <= 1.0 for cell in outcome.cells)


def test_naive_returns_every_detection_to_any(
    source: Recorded, outcomes: dict[str, Outcome]
) -> None:
    cell = next(c for c in outcomes["naive"].cells if (c.form, c.level) == ("Q1", "any"))
    assert cell.frames == cell.ids == len(source.truth.owner)


def test_naive_at_perfect_finds_every_object(outcomes: dict[str, Outcome]) -> None:
    first = outcomes["naive"].cells[0]
    assert (first.form, first.level) == ("Q1", "perfect")
    assert (first.miss["strict"], first.mrr["strict"]) == (0.0, 1.0)


def test_perfect_sensor_never_mixes_two_objects(outcomes: dict[str, Outcome]) -> None:
    assert outcomes["d3a+p-0.1"].identity.precision == 1.0
    assert outcomes["d3a+p-0.1"].identity.duplicates.mean == 1.0


def test_frame_reading_is_the_more_generous(outcomes: dict[str, Outcome]) -> None:
    for outcome in outcomes.values():
        for cell in outcome.cells:
            assert cell.miss["frame"] <= cell.miss["strict"]
            assert cell.mrr["frame"] >= cell.mrr["strict"]


def test_accuracies_are_three_ways_of_counting_perfect(outcomes: dict[str, Outcome]) -> None:
    for outcome in outcomes.values():
        nine, measured = outcome.accuracy(perfect=0.0), outcome.accuracy()
        six = outcome.accuracy(six=True)
        assert nine == pytest.approx((6 * six + 3) / 9)
        assert measured <= nine


def test_question_about_what_was_not_kept_is_a_miss(source: Recorded, work: Path) -> None:
    questions = draw(source.truth, source.zone, np.random.default_rng(0), count=40)
    with filled(D3A_D, source, work / "stores") as run:
        teach(run.store, source.truth, run.assignments)
        held = best_ids(source.truth.owner.tolist(), run.assignments)
        lost = [q for q in questions if q.form == "Q1" and q.targets and q.targets[0] not in held]
        judge = Judge(run, source.truth, source.zone)
        assert lost
        for question in lost:
            judged = judge.ask(question, "perfect")
            assert judged.empty
            assert judged.scores["strict"].missed()


def test_words_outside_of_the_vocabulary_are_not_taken_for_a_miss(
    source: Recorded, work: Path
) -> None:
    from grammar import QuestionError

    with filled(NAIVE, source, work / "stores") as run:
        judge = Judge(run, source.truth, source.zone)
        with pytest.raises(QuestionError):
            judge.ask(Question("Q1", (0,), {"category": "Did you ever flurb?"}), "category")


def test_a_refused_question_is_a_miss_that_is_named_and_the_others_are_asked(
    source: Recorded, work: Path
) -> None:
    read = draw(source.truth, source.zone, np.random.default_rng(0), count=1)[0]
    questions = [Question("Q1", (0,), {"category": "Is it going to rain?"}), read]
    with filled(NAIVE, source, work / "stores") as run:
        refused, *answered = Judge(run, source.truth, source.zone).ask_all(questions)
    assert refused.refused is not None
    assert "Is it going to rain?" in refused.refused
    assert refused.empty
    assert all(score.missed() for score in refused.scores.values())
    assert len(answered) == len(read.texts)
    assert [one.refused for one in answered] == [None] * len(answered)
    assert not all(one.empty for one in answered)


def test_evaluate_command_names_a_refused_question_once(source: Recorded, tmp_path: Path) -> None:
    folder = tmp_path / "odd"
    shutil.copytree(source.folder, folder)
    for name in ("detections.jsonl", "truth.jsonl"):
        lines = [json.loads(line) for line in (folder / name).read_text("utf-8").splitlines()]
        text = "".join(json.dumps(line | {"category": "weather"}) + "\n" for line in lines)
        (folder / name).write_text(text, encoding="utf-8")
    arguments = ["exp2", "--world", str(folder), "--queries", "1", "--quiet", "--json"]
    done = CliRunner().invoke(evaluate_command, arguments)
    assert done.exit_code == 0, done.output
    told = [line for line in done.stderr.splitlines() if line.startswith("refused")]
    assert told
    assert len(told) == len(set(told))
    assert all("weather" in line for line in told)
    assert any(outcome["refused"] for outcome in json.loads(done.stdout)["exp2"])


def test_hours_that_are_given_hold_for_the_growth_too() -> None:
    arguments = ["exp3", "--seeds", "3", "--hours", str(HOURS), "--quiet", "--json"]
    done = CliRunner().invoke(evaluate_command, arguments)
    assert done.exit_code == 0, done.output
    grown = json.loads(done.stdout)["exp3"]
    assert {growth["world"]["hours"] for growth in grown} == {HOURS}


def test_keyframes_of_the_papers_way_are_a_union_in_order_of_probability() -> None:
    seen = datetime(2020, 1, 1, tzinfo=UTC)

    def keyframe(name: str, probability: float, colour: float = 1.0) -> RankedKeyframe:
        why = {"attributes": {"red": colour}}
        return RankedKeyframe(
            9, 0.5, name, "cup", f"f{name}", probability, None, seen, seen, why=why, group=4
        )

    one = Answer(keyframes=(keyframe("a", 0.8), keyframe("b", 0.95)))
    two = Answer(keyframes=(keyframe("b", 0.95), keyframe("c", 0.9, colour=0.5)))
    found = by_probability([one, two]).keyframes
    assert [k.object_id for k in found] == ["b", "a", "c"]
    assert [k.rank for k in found] == [1, 2, 3]
    assert all(k.group is None for k in found)


def test_codes_without_noise_find_every_object_with_naive(work: Path) -> None:
    points = exp1.run([SMALL], work, Steps(running.quiet, 3), rates=(0.0,), methods=(NAIVE, OURS))
    naive, ours = points
    assert naive.miss == {"probability": 0.0, "cosine": 0.0}
    assert naive.mrr == {"probability": 1.0, "cosine": 1.0}
    assert ours.miss["cosine"] < 0.2


def test_another_order_is_of_all_keyframes_and_shows_each_id_once_first() -> None:
    seen = datetime(2020, 1, 1, tzinfo=UTC)
    shown = [RankedKeyframe(1, 0.5, i, "cup", "f", 0.9, None, seen, seen) for i in "aabcb"]
    ordered = exp1.by_cosine(shown, {"b": 0.9, "a": 0.2, "c": 0.5})
    assert "".join(one.object_id for one in ordered) == "bbcaa"
    assert "".join(one.object_id for one in exp1.once_each_first(ordered)) == "bcaba"


def test_whoever_orders_keyframes_anew_gets_all(source: Recorded, work: Path) -> None:
    with filled(OURS, source, work / "stores") as run:
        asker = Asker(run, datetime.fromtimestamp(source.truth.span_ms[1] / 1000, source.zone))
        text = f"Did you ever see a {source.truth.objects[0].category}?"
        part, _ = asker.ask(text, "any")
        whole, _ = asker.ask(text, "any", whole=True)
    assert len(part.keyframes) == CUT < len(whole.keyframes)


def test_bits_are_taught_where_they_are_set(work: Path, tmp_path: Path) -> None:
    from assistant.evaluation.questions import taught_name
    from d3a.store.base import Batch, ObjectRecord

    store = open_store(str(tmp_path / "bits.db"))
    vector = np.zeros(64, dtype=np.float32)
    vector[[2, 5, 7, 60]] = (1.0, 0.6, 0.4, 1.0)  # 60 is padding
    store.apply(Batch(objects=[ObjectRecord("a", "cup", 1.0, 0, 0, embedding=vector)]))
    exp1.teach_bits(store, things=59)
    assert sorted(n.word for n in store.names()) == sorted(map(taught_name, (2, 5)))
    store.close()


def test_naive_grows_by_its_detections_and_the_tiers_by_less(work: Path, source: Recorded) -> None:
    grown = {g.method.key: g for g in exp3.run([SMALL], work, Steps(running.quiet, 3))}
    assert grown["naive"].stays[-1] == len(source.truth.owner)
    assert 0 < grown["d3a+d"].stays[-1] < grown["naive"].stays[-1] / 4
    for growth in grown.values():
        assert list(growth.stays) == sorted(growth.stays)


def test_growth_is_told_as_mean_and_deviation_as_far_as_all_worlds_go(work: Path) -> None:
    worlds = [SMALL, World(seed=4, hours=1.2)]
    grown = exp3.run(worlds, work, Steps(running.quiet, 4), methods=(NAIVE, OURS))
    table = tables.exp3(grown)
    assert [row[0] for row in table.rows] == [NAIVE.title, OURS.title]
    assert table.head[1:3] == ("1 h", "per hour")
    first, second = (g.stays[0] for g in grown if g.method == NAIVE)
    assert table.rows[0][1] == tables.spread([first, second], 0)
    assert "seed 3, seed 4" in table.notes[1]


def test_nights_are_no_working_hours(work: Path) -> None:
    far = recorded(World(seed=1, hours=6.0), "nominal", work, depth=False)
    assert exp3.WorkingHours(far.truth).whole == 6  # 5.5 h on one day, half an hour on the next


def test_clusters_are_of_one_object_and_space_parts_them(work: Path) -> None:
    found = {c.method.key: c for c in exp4.run(SMALL, work, Steps(running.quiet, 3))}
    flat, ours = found["non-spatial"], found["default"]
    assert len(flat.owner) == len(ours.shows) == len(ours.cluster)
    assert flat.target in flat.shows
    assert flat.objects > ours.objects
    assert flat.stays < ours.stays


def test_report_is_one_page_with_every_table_and_plot(work: Path, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    seen: list[float] = []
    found = running.evaluate(
        ["exp2", "exp4"],
        [SMALL],
        tmp_path / "out",
        lambda share, text: seen.append(share),
        count=2,
        work=work,
    )
    page = (tmp_path / "out" / running.REPORT).read_text(encoding="utf-8")
    assert page.count("<svg") == 2
    assert "shape: what it shows" in page
    assert found.exp4[0].target in page[page.index("shape: what it shows") :]
    assert "http" not in page.replace("http://www.w3.org", "")  # but for SVG's own names
    for table in found.tables():
        assert table.title.replace("'", "&#x27;") in page
    assert "asked 2 questions of each form" in page
    assert page.count('<tr class="begins">') == 12  # the methods of a form and precision
    assert '<td class="words">Naive</td>' in page
    results = json.loads((tmp_path / "out" / running.RESULTS).read_text(encoding="utf-8"))
    assert len(results["exp2"]) == len(METHODS)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0


def test_given_recording_leaves_out_what_needs_another_sensor(source: Recorded, work: Path) -> None:
    given = World(folder=source.folder)
    steps = Steps(running.quiet, 2)
    found = exp2.run([given], work, steps, methods=(NAIVE_PLUS, D3A_P_EXACT), count=2)
    assert [o.method for o in found] == [NAIVE_PLUS]
    with pytest.raises(BadInput, match="needs a seed"):
        recorded(given, "drift", work)


def test_no_world_is_refused() -> None:
    with pytest.raises(BadInput, match="no world"):
        running.evaluate(worlds=[])


@pytest.mark.parametrize(
    ("text", "seeds"), [("0-4", (0, 1, 2, 3, 4)), ("3,7", (3, 7)), ("100-101, 5,5", (100, 101, 5))]
)
def test_seeds_are_ranges_and_lists(text: str, seeds: tuple[int, ...]) -> None:
    assert parse_seeds(text) == seeds


@pytest.mark.parametrize("text", ["", "a", "4-2", "1-", "-3", "1.5"])
def test_bad_seeds_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"seeds are|a range"):
        parse_seeds(text)


def test_spread_is_mean_and_deviation() -> None:
    assert tables.spread([0.5, None, 0.7]) == "0.60 ± 0.14"
    assert tables.spread([2558.0], 0) == "2,558"
    assert tables.spread([None]) == "-"


def test_simulate_command_prints_counts(tmp_path: Path) -> None:
    out = tmp_path / "w"
    done = CliRunner().invoke(
        simulate_command, [str(out), "--hours", "0.2", "--seed", "1", "--no-depth", "--statistics"]
    )
    assert done.exit_code == 0, done.output
    record = json.loads(done.stdout)
    assert record["objects"] == 59
    assert record["statistics"]["detections"] == record["detections"]
    refused = CliRunner().invoke(simulate_command, [str(out), "--condition", "fog"])
    assert refused.exit_code == 1
    assert "nominal" in refused.output


def test_evaluate_command_prints_tables(source: Recorded) -> None:
    arguments = ["exp4", "--world", str(source.folder), "--quiet"]
    done = CliRunner().invoke(evaluate_command, arguments)
    assert done.exit_code == 0, done.output
    assert "Exp 4" in done.stdout
    assert "Non-spatial" in done.stdout


def test_evaluate_command_prints_its_figures_as_one_json_object(
    source: Recorded, tmp_path: Path
) -> None:
    pytest.importorskip("matplotlib")
    out = tmp_path / "out"
    arguments = ["exp4", "exp2", "--queries", "1", "--world", str(source.folder)]
    options = ["--quiet", "--json", "--report", str(out)]
    done = CliRunner().invoke(evaluate_command, [*arguments, *options])
    assert done.exit_code == 0, done.output
    (line,) = done.stdout.splitlines()
    record = json.loads(line, parse_constant=pytest.fail)  # NaN and Infinity are no JSON
    assert record == json.loads((out / running.RESULTS).read_text(encoding="utf-8"))
    assert (record["schema"], record["reading"]) == (1, "strict")
    assert record["worlds"] == [source.folder.name]
    assert {o["method"]["key"] for o in record["exp2"]} >= {"naive", "d3a+d", "default"}
    assert record["exp1"] == record["exp3"] == []
    first = record["exp4"][0]
    assert len(first["cluster"]) == len(first["position"]) == len(first["owner"])
    for table in record["tables"]:
        assert all(len(row) == len(table["head"]) for row in table["rows"])


def test_evaluate_command_says_what_a_given_recording_cannot_do(source: Recorded) -> None:
    arguments = ["exp1", "--world", str(source.folder), "--quiet"]
    done = CliRunner().invoke(evaluate_command, arguments)
    assert done.exit_code == 0, done.output
    assert "exp1 needs a simulated world" in done.stderr
    for option in (["--seeds", "3"], ["--hours", "3"]):
        refused = CliRunner().invoke(evaluate_command, [*arguments, *option])
        assert refused.exit_code == 2
        assert f"{option[0]} is of simulated worlds" in refused.stderr


def test_evaluate_command_says_once_what_a_given_recording_lacks(
    source: Recorded, tmp_path: Path
) -> None:
    folder = tmp_path / "bare"
    shutil.copytree(source.folder, folder)
    for name, key in (("frames.jsonl", "pose"), ("detections.jsonl", "embedding")):
        lines = [json.loads(line) for line in (folder / name).read_text("utf-8").splitlines()]
        text = "".join(json.dumps(line | {key: None}) + "\n" for line in lines)
        (folder / name).write_text(text, encoding="utf-8")
    done = CliRunner().invoke(evaluate_command, ["exp1", "--world", str(folder), "--quiet"])
    assert done.exit_code == 0, done.output
    assert done.stderr.count("no frame has a pose") == 1
    assert done.stderr.count("no detection has an embedding") == 1


def test_a_half_simulated_world_is_called_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    out = tmp_path / "w"
    with monkeypatch.context() as patch:
        patch.setattr("d3a.simulation.writer.write_truth", interrupted)
        with pytest.raises(KeyboardInterrupt):
            simulate(out, hours=0.1, depth=False)
    assert not is_whole(out)
    with pytest.raises(BadInput, match="is not whole: what wrote it was interrupted"):
        open_source(out)
    (out / "truth.jsonl").touch()
    done = CliRunner().invoke(evaluate_command, ["exp4", "--world", str(out), "--quiet"])
    assert done.exit_code == 2
    assert "was interrupted" in done.stderr
    simulate(out, hours=0.1, depth=False)
    assert is_whole(out)
    assert "unfinished" not in (out / "recording.json").read_text(encoding="utf-8")


def test_evaluate_command_names_what_is_missing(tmp_path: Path) -> None:
    done = CliRunner().invoke(evaluate_command, ["exp4", "--world", str(tmp_path), "--quiet"])
    assert done.exit_code == 2
    assert "it has no recording.json, frames.jsonl, detections.jsonl and truth.jsonl" in done.stderr
    assert "d3a simulate" in done.stderr
