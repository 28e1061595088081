"""Detectors in ONNX files: every layout through OpenCV itself, and what is refused."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

from d3a import images
from d3a.detectors.classes import class_names
from d3a.detectors.feeding import Feeding
from d3a.detectors.layouts import recognise
from d3a.detectors.onnx import OnnxDetector
from d3a.detectors.onnx_file import OnnxFile
from d3a.detectors.opening import open_detector
from d3a.detectors.suppression import suppressed
from d3a.images import Pixels
from d3a.model import BadInput, Frame
from d3a.readers.opening import open_source
from tests.worlds.onnx_models import CLASSES, LAYOUTS, finder, names_file, scene

NAMES = str(dict(enumerate(CLASSES)))
KNOWN = {"yolo8-rows": "yolo8", "rtdetr-one": "rtdetr"}


def detector(path: Path, **options: str) -> OnnxDetector:
    found = open_detector(str(path), options)
    assert isinstance(found, OnnxDetector)
    return found


def seen(found: OnnxDetector, pixels: Pixels | None) -> list[tuple[str, list[int]]]:
    detections = found.detect(Frame("f", 0), pixels)
    return [(d.category, [round(edge) for edge in d.box]) for d in detections]


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("is_said", [False, True], ids=["recognised", "said"])
def test_each_layout_finds_the_things_where_they_are(
    tmp_path: Path, layout: str, is_said: bool
) -> None:
    name = KNOWN.get(layout, layout)
    options = {"layout": name} if is_said else {}
    found = detector(finder(tmp_path / "m.onnx", layout, names=NAMES), **options)
    assert f"layout {name}, 3 classes, input 64 x 48" in str(found)
    assert found.classes == ("cup", "bowl", "book")
    pixels = scene({(1, 1): "cup", (3, 2): "book", (0, 2): "bowl"})
    assert sorted(seen(found, pixels)) == [
        ("book", [48, 32, 64, 48]),
        ("bowl", [0, 32, 16, 48]),
        ("cup", [16, 16, 32, 32]),
    ]
    assert all(0.5 < d.probability <= 1 for d in found.detect(Frame("f", 0), pixels))
    assert seen(found, scene({})) == []
    assert seen(found, None) == []


@pytest.mark.parametrize(
    ("layout", "fit", "usual"),
    [
        ("yolo8", None, "centre"),
        ("yolox", None, "corner"),
        ("rtdetr", None, "stretch"),
        ("yolo8", "corner", "corner"),
        ("yolox", "stretch", "stretch"),
    ],
)
@pytest.mark.parametrize("shape", [(160, 128), (48, 100), (30, 40)])
def test_boxes_come_back_into_pictures_of_another_shape(
    tmp_path: Path, layout: str, fit: str | None, usual: str, shape: tuple[int, int]
) -> None:
    """The part of the picture that one cell of the input shows is painted, and no other."""
    options = {} if fit is None else {"fit": fit}
    found = detector(finder(tmp_path / "m.onnx", layout, names=NAMES), **options)
    pixels = np.full((*shape, 3), 114, dtype=np.uint8)
    _, placement = Feeding((48, 64), fit=usual).place(pixels)
    cell = np.array([[16.0, 16.0, 32.0, 32.0]], dtype=np.float32)
    x1, y1, x2, y2 = (round(float(edge)) for edge in placement.back(cell)[0])
    pixels[y1:y2, x1:x2] = (220, 30, 30)
    ((category, where),) = seen(found, pixels)
    assert category == "cup"
    assert np.abs(np.array(where) - (x1, y1, x2, y2)).max() <= 1


def test_the_threshold_and_the_overlap_are_options(tmp_path: Path) -> None:
    path = finder(tmp_path / "m.onnx", names=NAMES)
    pixels = scene({(1, 1): "cup"})
    pixels[0:16, 0:16] = (160, 60, 60)  # a pale red: 0.16
    assert [c for c, _ in seen(detector(path), pixels)] == ["cup"]
    assert [c for c, _ in seen(detector(path, threshold="0.1"), pixels)] == ["cup", "cup"]
    assert seen(detector(path, threshold="0.9"), pixels) == []


def test_objectness_counts(tmp_path: Path) -> None:
    for layout in ("yolo5", "yolox"):
        path = finder(tmp_path / f"{layout}.onnx", layout, names=NAMES, objectness=0.5)
        (found,) = detector(path).detect(Frame("f", 0), scene({(1, 1): "cup"}))
        assert found.probability == pytest.approx(0.5 * (220 - 30 - 30) / 255, abs=1e-3)


def test_pictures_go_through_in_batches(tmp_path: Path) -> None:
    found = detector(finder(tmp_path / "m.onnx", batch=2, names=NAMES))
    assert found.batch == 2
    pictures = [scene({(n, 0): "cup"}) for n in range(3)]
    frames = [Frame(str(n), n) for n in range(4)]
    all_found = found.detect_all(frames, [*pictures[:2], None, pictures[2]])
    assert [[round(d.box[0]) for d in each] for each in all_found] == [[0], [16], [], [32]]
    one = detector(finder(tmp_path / "one.onnx", names=NAMES))
    assert all_found[0] == one.detect(frames[0], pictures[0])


def test_an_open_size_is_said_and_a_fixed_one_is_kept(tmp_path: Path) -> None:
    path = finder(tmp_path / "m.onnx", names=NAMES, input_shape=(1, 3, "h", "w"))
    with pytest.raises(BadInput, match=r"leaves the size of its input open \(1 x 3 x \? x \?\)"):
        detector(path)
    assert len(seen(detector(path, size="64x48"), scene({(1, 1): "cup"}))) == 1
    fixed = finder(tmp_path / "fixed.onnx", names=NAMES)
    with pytest.raises(BadInput, match="takes pictures of 64 x 48 only, not 48x64"):
        detector(fixed, size="48x64")


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"lay": "yolo8"}, "has no option 'lay'. Did you mean layout"),
        ({"layout": "yolo9"}, "it takes yolo8, yolo5"),
        ({"layout": "yolox"}, "has not the layout 'yolox' with 3 classes; it would be yolo8"),
        ({"threshold": "2"}, "must be at most 1"),
        ({"threshold": "0"}, "must be above 0"),
        ({"threshold": "high"}, "is not a number"),
        ({"size": "big"}, "640x480 would do"),
        ({"batch": "4"}, "takes 1 picture.s. at a time, not 4"),
        ({"threads": "none"}, "a whole number above 0 would do"),
        ({"pixels": "grey"}, "it takes rgb-1"),
        ({"classes": "nowhere.txt"}, "there is no such file"),
    ],
)
def test_options_that_cannot_be_are_refused(
    tmp_path: Path, options: dict[str, str], said: str
) -> None:
    path = finder(tmp_path / "m.onnx", names=NAMES)
    with pytest.raises(BadInput, match=said):
        detector(path, **options)


def test_a_list_of_other_classes_is_refused_with_what_would_fit(tmp_path: Path) -> None:
    path = finder(tmp_path / "m.onnx", names=str([f"thing {n}" for n in range(80)]))
    with pytest.raises(BadInput) as refused:
        detector(path)
    assert str(refused.value).startswith(
        "m.onnx: the model's output 1 x 7 x 12 has no known layout with 80 classes. A candidate "
        "needs 84 numbers (yolo8), 85 (yolo5, yolox) or 6 (end2end)"
    )
    assert "7 numbers a candidate would be 3 classes (yolo8) or 2 (yolo5, yolox)" in str(
        refused.value
    )


def test_two_layouts_of_one_shape_are_asked_about() -> None:
    output = np.zeros((1, 12, 6), dtype=np.float32)
    output[0, :, :4] = 30
    with pytest.raises(BadInput, match="may be of the layout yolo8 or end2end: say which"):
        recognise([output], (48, 64), 2)
    assert recognise([output], (48, 64), 2, "yolo8").layout.name == "yolo8"
    assert recognise([output], (48, 64), 2, "end2end").layout.name == "end2end"


def test_masks_beside_the_boxes_are_left_alone() -> None:
    boxes = np.zeros((1, 4 + 3 + 32, 12), dtype=np.float32)
    boxes[0, :4] = 30
    boxes[0, 4 + 1, 5] = 0.9
    boxes[0, 7:] = 5
    found = recognise([boxes, np.zeros((1, 32, 12, 16), dtype=np.float32)], (48, 64), 3)
    candidates = found.candidates([boxes])
    assert found.is_turned
    assert candidates.scores.shape == (12, 3)
    assert candidates.scores[5].tolist() == pytest.approx([0, 0.9, 0])


def test_grids_that_are_decoded_already_are_taken_as_they_are() -> None:
    """YOLOX may be exported with its boxes in pixels; YOLO v6 has an objectness of one."""
    centres = [
        ((column + 0.5) * stride, (row + 0.5) * stride, stride, stride)
        for stride in (8, 16, 32)
        for row in range(64 // stride)
        for column in range(64 // stride)
    ]
    table = np.zeros((1, len(centres), 5 + 3), dtype=np.float32)
    table[0, :, :4] = centres
    found = recognise([table], (64, 64), 3)
    assert (found.layout.name, found.grid) == ("yolox", None)
    assert found.candidates([table]).boxes[0].tolist() == [0, 0, 8, 8]
    table[0, :, 4] = 1
    assert recognise([table], (64, 64), 3).layout.name == "yolo5"


def test_numbers_that_are_none_are_no_detections(tmp_path: Path) -> None:
    output = np.zeros((1, 12, 7), dtype=np.float32)
    output[0, :, :4] = (30, 30, 10, 10)
    reading = recognise([output], (48, 64), 3)
    output[0, 0, 0] = np.nan
    output[0, 1, 2] = np.inf
    output[0, :3, 4] = 0.9
    output[0, 3, 5] = np.nan
    found = detector(finder(tmp_path / "m.onnx", names=NAMES))
    candidates = reading.candidates([output])
    _, placement = Feeding((48, 64)).place(scene({}))
    (kept,) = found._detections(candidates, placement)
    assert kept.box == (25, 25, 35, 35)


def test_the_best_of_boxes_that_share_most_is_kept() -> None:
    boxes = np.array([[0, 0, 10, 10], [1, 0, 11, 10], [0, 0, 10, 10], [30, 0, 40, 10]], np.float32)
    kinds = np.array([0, 0, 1, 0])
    assert suppressed(boxes, kinds, 0.5).tolist() == [0, 2, 3]
    assert suppressed(boxes, kinds, 0.95).tolist() == [0, 1, 2, 3]
    assert suppressed(boxes[:0], kinds[:0], 0.5).tolist() == []


@pytest.mark.parametrize(
    ("written", "said"),
    [
        ("{0: 'cup', 1: 'red bowl'}", ("cup", "red bowl")),
        ("['cup', 'N/A', 'bowl']", ("cup", "", "bowl")),
        ('{"1": "cup"}', None),
        ("__import__('os')", None),
        ("(" * 5000, None),
        ("[]", None),
        ("['']", None),
        ("[1]", None),
    ],
)
def test_names_in_the_metadata(written: str, said: tuple[str, ...] | None) -> None:
    file = OnnxFile((), (), {"names": written})
    if said is not None:
        assert class_names(Path("m.onnx"), file, None) == said
        return
    with pytest.raises(BadInput, match=r"m\.onnx"):
        class_names(Path("m.onnx"), file, None)


def test_names_in_a_file_win_and_must_be_names(tmp_path: Path) -> None:
    path = finder(tmp_path / "m.onnx", names=NAMES)
    given = names_file(tmp_path / "names.txt", ["mug", "-", "paper\tback"])
    found = detector(path, classes=str(given))
    assert found.classes == ("mug", "paper back")
    assert seen(found, scene({(0, 0): "cup", (2, 0): "bowl"})) == [("mug", [0, 0, 16, 16])]
    assert detector(path, classes="names.txt").classes == found.classes  # beside the model
    with pytest.raises(BadInput, match=r"n\.txt:2: the category is empty"):
        detector(path, classes=str(names_file(tmp_path / "n.txt", ["a", "", "b"])))
    with pytest.raises(BadInput, match="names no class"):
        detector(path, classes=str(names_file(tmp_path / "n.txt", [])))
    (tmp_path / "n.txt").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(BadInput, match="cannot be read as text"):
        detector(path, classes=str(tmp_path / "n.txt"))
    with pytest.raises(BadInput, match="does not say what its classes are called: give --classes"):
        detector(finder(tmp_path / "bare.onnx"))


def test_models_that_cannot_be_used_are_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="cannot be read: No such file"):
        open_detector(str(tmp_path / "m.onnx"))
    flat = finder(tmp_path / "flat.onnx", names=NAMES, input_shape=(1, 10))
    with pytest.raises(BadInput, match="takes 1 x 10; a colour picture would be 1 x 3 x height"):
        open_detector(str(flat))
    wrong = finder(tmp_path / "wrong.onnx", names=NAMES, input_shape=(1, 3, 96, 96))
    with pytest.raises(BadInput, match=r"OpenCV cannot (load|run)"):
        open_detector(str(wrong))


def test_a_model_and_its_settings_are_told_apart(tmp_path: Path) -> None:
    path = finder(tmp_path / "m.onnx", names=NAMES)
    one, same, other = detector(path), detector(path), detector(path, threshold="0.3")
    assert one.identity == same.identity != other.identity
    assert one.identity.startswith("m.onnx ")


def test_a_detector_can_be_sent_to_another_process(tmp_path: Path) -> None:
    found = detector(finder(tmp_path / "m.onnx", names=NAMES), threshold="0.3")
    sent = pickle.loads(pickle.dumps(found))
    assert sent.identity == found.identity
    pixels = scene({(1, 1): "cup"})
    assert sent.detect(Frame("f", 0), pixels) == found.detect(Frame("f", 0), pixels)


def recorded(shared: Path, every: int) -> list[Frame]:
    return [
        frame
        for number, frame in enumerate(open_source(shared / "data/red-kitchen"))
        if number % every == 0
    ]


def test_a_real_model_gives_the_boxes_that_came_with_the_recording(shared: Path) -> None:
    """They were made by the same model, with letterbox and suppression as they should be."""
    models = shared / "models"
    found = detector(
        models / "yolo11n-640.onnx", classes=str(models / "coco80.txt"), threshold="0.1"
    )
    compared = 0
    for frame in recorded(shared, 35):
        assert frame.image is not None
        assert frame.detections is not None
        ours = found.detect(frame, images.decode(frame.image))
        assert [d.category for d in ours] == [d.category for d in frame.detections]
        for mine, theirs in zip(ours, frame.detections, strict=True):
            assert mine.box == pytest.approx(theirs.box, abs=0.1)
            assert mine.probability == pytest.approx(theirs.probability, abs=2e-4)
            compared += 1
    assert compared >= 15


def test_both_real_families_are_recognised(shared: Path) -> None:
    models, frame = shared / "models", recorded(shared, 140)[0]
    assert frame.image is not None
    pixels = images.decode(frame.image)
    said = {}
    for name in ("yolo11n-608x1088", "yolox-nano-416"):
        found = detector(models / f"{name}.onnx", classes=str(models / "coco80.txt"))
        said[name] = str(found).partition(": ")[2]
        assert {"cup", "chair", "dining table"} <= {
            d.category for d in found.detect(frame, pixels)
        }, name
    assert said == {
        "yolo11n-608x1088": "layout yolo8, 80 classes, input 1088 x 608 rgb-1, centre, "
        "threshold 0.25",
        "yolox-nano-416": "layout yolox, 80 classes, input 416 x 416 bgr-255, corner, "
        "threshold 0.25",
    }
