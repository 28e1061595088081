"""An ingest that looks at the pictures itself: a detector, an embedder, and what a store keeps."""

from __future__ import annotations

import json
import pickle
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from assistant.batch import run
from d3a import images
from d3a.answer import Answer
from d3a.colours.looks import carries_histogram, histograms
from d3a.detectors.base import Detector
from d3a.detectors.opening import open_detector
from d3a.embedders.base import CARRIED_LENGTH, Embedder, HistogramEmbedder, WithColours
from d3a.embedders.opening import open_embedder
from d3a.exporting import export
from d3a.images import HISTOGRAM_MODEL, Pixels
from d3a.ingest import IngestSummary, ingest
from d3a.ingesting.preparation import BROKEN_PICTURE, NO_PICTURE
from d3a.ingesting.sieve import BACKWARDS
from d3a.model import BadInput, D3AError, Detection, Frame
from d3a.parameters import DEFAULT, PAPER, Parameters
from d3a.readers.base import RecordingFacts
from d3a.readers.opening import open_source
from tests.worlds.onnx_models import CLASSES, finder, mean_colour, scene
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import START_MS, ListReader, frame_line, write_recording

NAMES = str(dict(enumerate([*CLASSES])))
NOW = datetime(2030, 1, 1, tzinfo=UTC)


def looker(folder: Path, **options: str) -> Detector:
    found = open_detector(str(finder(folder / "m.onnx", names=NAMES)), options)
    assert found is not None
    return found


def pictured(
    things: Sequence[dict[tuple[int, int], str]], detections: tuple[Detection, ...] | None = None
) -> ListReader:
    frames = [
        Frame(f"{n:03d}", START_MS + 1000 * n, image=scene(each), detections=detections)
        for n, each in enumerate(things)
    ]
    return ListReader(frames, RecordingFacts("made", zone="UTC", frames=len(frames)))


CUP = {(1, 1): "cup"}
BOTH = {(1, 1): "cup", (3, 0): "book"}


def ingested(
    reader: ListReader,
    detector: Detector | None = None,
    embedder: Embedder | None = None,
    parameters: Parameters = DEFAULT,
) -> tuple[IngestSummary, OracleStore]:
    store = OracleStore()
    return ingest(reader, store, parameters, detector=detector, embedder=embedder), store


def asked(store: OracleStore, question: str) -> Answer:
    (answer,) = run(store, [question], now=NOW)
    return answer


@pytest.mark.parametrize("parameters", [DEFAULT, PAPER], ids=["default", "paper"])
def test_a_detector_makes_a_memory_of_pictures_alone(
    tmp_path: Path, parameters: Parameters
) -> None:
    summary, store = ingested(pictured([CUP, BOTH] * 6), looker(tmp_path), parameters=parameters)
    assert (summary.frames, summary.detections) == (12, 18)
    assert set(summary.seconds) == {"read", "decode", "detect", "embed", "tiers", "store"}
    assert summary.seconds["detect"] > 0
    assert sorted({record.category for record in store.objects()}) == ["book", "cup"]
    assert store.meta("classes") == ["book", "bowl", "cup"]
    assert store.check() == []


def test_a_word_that_is_not_known_is_told_from_a_thing_never_seen(tmp_path: Path) -> None:
    _, store = ingested(pictured([CUP] * 6), looker(tmp_path))
    assert asked(store, "Did you ever see a cup?").status == "found"
    assert asked(store, "Did you ever see a bowl?").reason == "never"
    assert asked(store, "Did you ever see a chair?").reason == "not_recognisable"


def test_a_detector_replaces_recorded_boxes(tmp_path: Path) -> None:
    there = (Detection("vase", 0.9, (0, 0, 20, 20), embedding=images.histogram(scene({}))),)
    reader = pictured([CUP] * 4, there)
    reader.facts = replace(
        reader.facts, classes=("vase",), embedding_model="other", min_probability=0.95
    )
    _, store = ingested(reader, looker(tmp_path))
    assert [record.category for record in store.objects()] == ["cup"]
    assert store.meta("classes") == ["book", "bowl", "cup"]
    assert store.meta("embedding_model") == HISTOGRAM_MODEL


def test_what_has_no_picture_is_counted_and_the_rest_looked_at(tmp_path: Path) -> None:
    reader = pictured([CUP] * 5)
    frames = list(reader.frames)
    frames[1] = replace(frames[1], image=None)
    frames[2] = replace(frames[2], image=b"")
    frames[3] = replace(frames[3], image=b"\xff\xd8 no picture")
    summary, store = ingested(ListReader(frames, reader.facts), looker(tmp_path))
    assert summary.skipped.counts == {NO_PICTURE: 1, BROKEN_PICTURE: 2}
    assert (summary.frames, summary.detections) == (5, 2)
    assert store.check() == []


def test_a_recording_is_looked_at_by_one_detector(tmp_path: Path) -> None:
    reader, store = pictured([CUP] * 6), OracleStore()
    detector = looker(tmp_path)
    ingest(reader, store, DEFAULT, detector=detector, max_frames=3)
    with pytest.raises(BadInput, match=r"was taken in with --detector m\.onnx \w{8}, not m\.onnx"):
        ingest(reader, store, DEFAULT, detector=looker(tmp_path, threshold="0.3"))
    with pytest.raises(BadInput, match=r"with --detector m\.onnx \w{8}, not recorded:"):
        ingest(pictured([CUP] * 6, ()), store, DEFAULT)
    ingest(reader, store, DEFAULT, detector=looker(tmp_path))
    whole = ingested(reader, detector)[1]
    assert list(store.dump()) == list(whole.dump())
    assert ingest(reader, store, DEFAULT, detector=detector).already


def test_batches_fill_the_same_store(tmp_path: Path) -> None:
    """The store cannot tell how many pictures went through the network at once."""
    things = [CUP, BOTH, {}, CUP, BOTH, CUP, BOTH]
    one = ingested(pictured(things), looker(tmp_path))[1]
    path = finder(tmp_path / "m.onnx", names=NAMES, input_shape=("n", 3, 48, 64), batch=3)
    three = open_detector(str(path), {"batch": "3"})
    assert three is not None
    found = ingested(pictured(things), three)[1]
    assert [r.category for r in found.objects()] == [r.category for r in one.objects()]
    assert [s.box for s in found.sightings()] == [s.box for s in one.sightings()]


class Counting:
    """A detector that notes how many frames it is shown at once."""

    classes, identity, batch = ("cup",), "counting", 3

    def __init__(self) -> None:
        self.shown: list[int] = []

    def detect(self, frame: Frame, pixels: Pixels | None) -> tuple[Detection, ...]:
        raise AssertionError("it takes several")

    def detect_all(
        self, frames: Sequence[Frame], pictures: Sequence[Pixels | None]
    ) -> list[tuple[Detection, ...]]:
        self.shown.append(len(frames))
        return [(Detection("cup", 0.9, (16, 16, 32, 32)),) for _ in frames]


def test_frames_are_shown_together_and_left_out_ones_in_their_place() -> None:
    reader, counting = pictured([CUP] * 8), Counting()
    frames = list(reader.frames)
    frames[2] = replace(frames[2], time_ms=START_MS)  # runs backwards
    summary, store = ingested(ListReader(frames, reader.facts), counting)
    assert counting.shown == [3, 3, 1]
    assert (summary.frames, summary.detections) == (7, 7)
    assert summary.skipped.counts == {BACKWARDS: 1}
    late = Counting()
    ingest(reader, store := OracleStore(), DEFAULT, detector=late, max_frames=4)
    ingest(reader, store, DEFAULT, detector=late)
    whole = ingested(reader, Counting())[1]
    assert list(store.dump()) == list(whole.dump())


def test_an_embedder_compares_looks_and_colours_can_still_be_asked(tmp_path: Path) -> None:
    embedder = open_embedder(str(mean_colour(tmp_path / "look.onnx")), {"pixels": "rgb-1"})
    summary, store = ingested(pictured([BOTH] * 6), looker(tmp_path), embedder)
    assert summary.seconds["embed"] > 0
    assert store.meta("embedding_model") == embedder.name
    assert embedder.name.startswith("look-")
    assert embedder.name.endswith("+rgb-8x8x8")
    for record in store.objects():
        assert record.embedding is not None
        assert len(record.embedding) == 3 + 512
        assert carries_histogram(record.embedding_model, len(record.embedding))
        peak = {"cup": 6 * 64, "book": 6}[record.category]  # 220 is the seventh of eight parts
        assert int(histograms(record.embedding[None])[0].argmax()) == peak
    red = asked(store, "Where is the red cup?")
    assert (red.status, red.unjudged) == ("found", ())
    assert asked(store, "Where is the green cup?").status == "not_found"
    plain = ingested(pictured([BOTH] * 6), looker(tmp_path))[1]
    told = asked(plain, "Where is the red cup?").keyframes[0].why["attributes"]["red"]
    assert red.keyframes[0].why["attributes"]["red"] == pytest.approx(told, abs=0.02)


def test_an_embedder_can_be_sent_to_another_process(tmp_path: Path) -> None:
    embedder = open_embedder(str(mean_colour(tmp_path / "look.onnx")), {"pixels": "rgb-1"})
    sent = pickle.loads(pickle.dumps(embedder))
    assert sent.name == embedder.name
    assert np.array_equal(sent.embed([scene(CUP)]), embedder.embed([scene(CUP)]))


def test_an_export_keeps_the_colours(tmp_path: Path) -> None:
    embedder = open_embedder(str(mean_colour(tmp_path / "look.onnx")))
    store = ingested(pictured([BOTH] * 6), looker(tmp_path), embedder)[1]
    export(store, tmp_path / "out", "recording", ids=None, zone=UTC)
    again = OracleStore()
    ingest(open_source(tmp_path / "out"), again, DEFAULT)
    assert again.meta("embedding_model") == embedder.name
    answer = asked(again, "Where is the red cup?")
    assert (answer.status, answer.unjudged) == ("found", ())


def test_what_is_carried_does_not_count_in_a_comparison(tmp_path: Path) -> None:
    embedder = open_embedder(str(mean_colour(tmp_path / "look.onnx")), {"pixels": "rgb-1"})
    crops = [scene({(0, 0): name})[:16, :16] for name in ("cup", "bowl")]
    red, green = images.unit(embedder.embed(crops))
    plain = images.unit(np.array([[220, 30, 30], [30, 220, 30]], dtype=np.float32))
    assert float(red @ green) == pytest.approx(float(plain[0] @ plain[1]), abs=CARRIED_LENGTH**2)
    assert np.linalg.norm(histograms(np.stack([red]))) == pytest.approx(CARRIED_LENGTH)


def test_a_model_of_512_numbers_is_no_histogram() -> None:
    """CLIP has as many numbers as the histogram: colours must not be read out of them."""
    rng = np.random.default_rng(0)
    look = images.unit(rng.random(512).astype(np.float32))
    there = (Detection("cup", 0.9, (16, 16, 32, 32), embedding=look),)
    reader = pictured([CUP] * 6, there)
    reader.facts = replace(reader.facts, embedding_model="clip")
    store = ingested(reader)[1]
    answer = asked(store, "Where is the red cup?")
    assert (answer.status, answer.unjudged) == ("found", ("red",))


def test_an_embedder_replaces_recorded_embeddings_of_another() -> None:
    look = np.eye(1, 64, dtype=np.float32)[0]
    there = (Detection("cup", 0.9, (16, 16, 32, 32), embedding=look),)
    reader = pictured([CUP] * 4, there)
    reader.facts = replace(reader.facts, embedding_model="two")
    assert ingested(reader)[1].objects()[0].embedding_model == "two"
    store = ingested(reader, embedder=HistogramEmbedder())[1]
    (record,) = store.objects()
    assert record.embedding_model == HISTOGRAM_MODEL
    assert record.embedding is not None
    assert int(record.embedding.argmax()) == 6 * 64


def test_a_store_of_another_embedding_is_refused(tmp_path: Path) -> None:
    reader, store = pictured([CUP] * 3), OracleStore()
    ingest(reader, store, DEFAULT, detector=looker(tmp_path))
    before = list(store.dump())
    embedder = open_embedder(str(mean_colour(tmp_path / "look.onnx")))
    later = pictured([CUP] * 3)
    later.facts = replace(later.facts, name="later")
    with pytest.raises(D3AError, match=r"holds embeddings of 'rgb-8x8x8', the recording has 'look"):
        ingest(later, store, DEFAULT, detector=looker(tmp_path), embedder=embedder)
    assert list(store.dump()) == before


def test_embedders_in_files_are_told_apart_and_refused_where_they_cannot_be(tmp_path: Path) -> None:
    path = mean_colour(tmp_path / "look.onnx")
    assert open_embedder(str(path)).name == open_embedder(str(path)).name
    assert open_embedder(str(path)).name != open_embedder(str(path), {"fit": "centre"}).name
    other = mean_colour(tmp_path / "look.onnx", scale=2.0)
    assert open_embedder(str(other)).name not in (open_embedder(str(path), {"fit": "centre"}).name,)
    assert "3 numbers, input 8 x 8 rgb-imagenet, stretch" in str(open_embedder(str(path)))
    for options, said in (
        ({"output": "logits"}, "has no output 'logits'; it has t2"),
        ({"layout": "yolo8"}, "has no option 'layout'"),
    ):
        with pytest.raises(BadInput, match=said):
            open_embedder(str(path), options)
    with pytest.raises(BadInput, match="cannot be read: No such file"):
        open_embedder(str(tmp_path / "none.onnx"))
    with pytest.raises(BadInput, match="has no options, and 'fit' is one"):
        open_embedder(HISTOGRAM_MODEL, {"fit": "centre"})


class Odd:
    name = "odd"

    def __init__(self, rows: object) -> None:
        self.rows = rows

    def embed(self, crops: Sequence[Pixels]) -> NDArray[np.float32]:
        return np.asarray(self.rows, dtype=np.float32)


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ([[1.0, np.nan]], "numbers that are not finite"),
        ([[1.0], [2.0]], "gave 2 x 1 numbers for 1 pictures"),
        ([1.0], "gave 1 numbers for 1 pictures"),
        ([[]], "gave 1 x 0 numbers"),
        ([[1.0] * 3585], "gives 3585 numbers; a store keeps 3584 at most"),
    ],
)
def test_vectors_that_are_none_are_refused(rows: object, said: str) -> None:
    odd = Odd(rows)
    with pytest.raises(BadInput, match=said):
        WithColours(odd).embed([scene({})])


def test_a_recording_folder_is_looked_at_from_its_pictures(tmp_path: Path) -> None:
    folder = write_recording(
        tmp_path / "r", [frame_line(n, image=f"images/{n}.jpg") for n in range(4)], []
    )
    (folder / "detections.jsonl").unlink()
    (folder / "images").mkdir()
    for n in range(4):
        (folder / "images" / f"{n}.jpg").write_bytes(images.encode(scene(BOTH), 64, 95))
    facts = json.loads((folder / "recording.json").read_text())
    facts["camera"] |= {"width": 64, "height": 48}
    (folder / "recording.json").write_text(json.dumps(facts))
    store = OracleStore()
    with pytest.raises(BadInput, match="it needs a detector"):
        ingest(open_source(folder), store, DEFAULT)
    ingest(open_source(folder), store, DEFAULT, detector=looker(tmp_path))
    assert sorted(r.category for r in store.objects()) == ["book", "cup"]
