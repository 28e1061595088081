"""Detectors and embedders of other packages: found by entry points, their mistakes told."""

from __future__ import annotations

import pickle
import sys
from pathlib import Path

import numpy as np
import pytest

from d3a.detectors.base import BatchDetector
from d3a.detectors.opening import open_detector
from d3a.embedders.opening import open_embedder
from d3a.model import BadInput, Detection, Frame
from tests.worlds.onnx_models import scene

PLUGIN = '''
"""The plug-in of the README."""

import numpy as np

from d3a.model import Detection


class RedThings:
    """Calls the reddest part of a picture a red thing."""

    classes = ("red thing",)

    def __init__(self, options):
        self.least = float(options.get("least", 100))

    def detect(self, frame, pixels):
        if pixels is None:
            return ()
        red = pixels[..., 0].astype(int) - pixels[..., 1:].max(axis=2) > self.least
        if not red.any():
            return ()
        rows, columns = np.nonzero(red)
        box = (columns.min(), rows.min(), columns.max() + 1, rows.max() + 1)
        return (Detection("red thing", 0.9, tuple(map(float, box))),)


class MeanColour:
    name = "mean-colour"

    def __init__(self, options):
        self.options = options

    def embed(self, crops):
        return np.array([crop.mean(axis=(0, 1)) for crop in crops])


class Broken:
    name, classes = "broken", ()

    def __init__(self, options):
        if "fail" in options:
            raise KeyError("no model here")

    def detect(self, frame, pixels):
        raise RuntimeError("out of memory")

    embed = None


class Wrong(Broken):
    classes = ("thing",)

    def detect(self, frame, pixels):
        return [("cup", 0.9)]


class Escaping(Broken):
    classes = ("cu\\x1b[31mp",)

    def detect(self, frame, pixels):
        return [Detection("cu\\x1b[31mp", 0.5, (0, 0, 4, 4), embedding=np.ones(3), row=7)]


class Named(MeanColour):
    name = "rgb-mine"


class Listed(Broken):
    classes = "cup"


class Several(RedThings):
    batch = 2

    def detect_all(self, frames, pictures):
        if any(pixels is not None and pixels.max() < 115 for pixels in pictures):
            raise MemoryError
        found = [self.detect(*pair) for pair in zip(frames, pictures)]
        return found[1:] if frames[0].name == "short" else found


class Unsaid(Several):
    batch = "two"


number = 7
'''
METADATA = "Metadata-Version: 2.1\nName: {name}\nVersion: 1.2\n"
ENTRIES = """[d3a.detectors]
red = {module}:RedThings
broken = {module}:Broken
wrong = {module}:Wrong
escaping = {module}:Escaping
listed = {module}:Listed
number = {module}:number
several = {module}:Several
unsaid = {module}:Unsaid
gone = {module}:NotThere
nowhere = no_such_module_of_anybody:Thing

[d3a.embedders]
mean = {module}:MeanColour
named = {module}:Named
broken = {module}:Broken
"""


def install(folder: Path, name: str = "d3a-red") -> None:
    """Put a distribution with entry points where Python looks for them."""
    module = name.replace("-", "_")
    (folder / f"{module}.py").write_text(PLUGIN, encoding="utf-8")
    about = folder / f"{module}-1.2.dist-info"
    about.mkdir()
    (about / "METADATA").write_text(METADATA.format(name=name), encoding="utf-8")
    (about / "entry_points.txt").write_text(ENTRIES.format(module=module), encoding="utf-8")


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "site"
    folder.mkdir()
    install(folder)
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.delitem(sys.modules, "d3a_red", raising=False)
    return folder


def test_a_detector_of_another_package(site: Path) -> None:
    found = open_detector("red", {"least": "50"})
    assert found is not None
    assert found.classes == ("red thing",)
    assert found.identity == 'red d3a-red 1.2 {"least": "50"}'
    assert found.detect(Frame("f", 0), scene({(1, 1): "cup"})) == (
        Detection("red thing", 0.9, (16.0, 16.0, 32.0, 32.0)),
    )
    assert found.detect(Frame("f", 0), scene({(1, 1): "book"})) == ()
    strict = open_detector("red", {"least": "250"})
    assert strict is not None
    assert strict.detect(Frame("f", 0), scene({(1, 1): "cup"})) == ()


def test_an_embedder_of_another_package_carries_the_colours_too(site: Path) -> None:
    found = open_embedder("mean")
    assert (found.name, str(found)) == ("mean-colour+rgb-8x8x8", "mean-colour")
    vectors = found.embed([scene({(0, 0): "cup"})[:16, :16], scene({})])
    assert vectors.shape == (2, 3 + 512)
    assert np.linalg.norm(vectors[0]) == pytest.approx(1, abs=1e-3)
    assert vectors[0, :3] == pytest.approx(np.array([220, 30, 30]) / 224.05, abs=1e-3)


def test_a_plug_in_may_take_several_frames_at_once(site: Path) -> None:
    opened: object = open_detector("several")
    assert isinstance(opened, BatchDetector)
    found: BatchDetector = opened
    assert found.batch == 2
    frames = [Frame("a", 0), Frame("b", 1)]
    pictures = [scene({(1, 1): "cup"}), scene({(2, 2): "book"})]
    assert [len(each) for each in found.detect_all(frames, pictures)] == [1, 0]
    assert found.detect_all([], []) == []
    with pytest.raises(BadInput, match="'several' on frame a failed: MemoryError"):
        found.detect_all(frames, [pictures[0], scene({})])
    with pytest.raises(BadInput, match="'several' gave 1 answers for 2 frames"):
        found.detect_all([Frame("short", 0), frames[1]], pictures)
    one = open_detector("red")
    assert not isinstance(one, BatchDetector)


def test_plug_ins_can_be_sent_to_another_process(site: Path) -> None:
    detector = pickle.loads(pickle.dumps(open_detector("red", {"least": "50"})))
    assert detector.identity == 'red d3a-red 1.2 {"least": "50"}'
    assert len(detector.detect(Frame("f", 0), scene({(1, 1): "cup"}))) == 1
    embedder = pickle.loads(pickle.dumps(open_embedder("mean")))
    assert embedder.embed([scene({})]).shape == (1, 3 + 512)


def test_nothing_is_imported_before_it_is_asked_for(site: Path) -> None:
    with pytest.raises(BadInput, match=r"there is no detector 'rde'.* Did you mean red\?"):
        open_detector("rde")
    assert "d3a_red" not in sys.modules
    assert open_detector("recorded") is None
    with pytest.raises(BadInput, match="no embedder 'clip'; there are broken, mean, named, rgb-8"):
        open_embedder("clip")
    with pytest.raises(BadInput, match="recorded boxes take no option, and 'layout' is one"):
        open_detector("recorded", {"layout": "yolo8"})


@pytest.mark.parametrize(
    ("name", "options", "said"),
    [
        ("broken", {"fail": "1"}, r"'broken' \(d3a_red:Broken\) failed: KeyError: 'no model here'"),
        ("gone", {}, "failed: AttributeError: module 'd3a_red' has no attribute 'NotThere'"),
        ("nowhere", {}, "failed: ModuleNotFoundError: No module named"),
        ("number", {}, "failed: TypeError: 'int' object is not callable"),
        ("unsaid", {}, "has detect_all, and no batch of 1 or more"),
        ("listed", {}, "has classes that are no list of names"),
    ],
)
def test_a_detector_that_cannot_be_made(
    site: Path, name: str, options: dict[str, str], said: str
) -> None:
    with pytest.raises(BadInput, match=said):
        open_detector(name, options)


def test_a_detector_that_fails_names_the_frame(site: Path) -> None:
    broken, wrong = open_detector("broken"), open_detector("wrong")
    assert broken is not None
    assert wrong is not None
    with pytest.raises(BadInput, match="'broken' on frame f7 failed: RuntimeError: out of memory"):
        broken.detect(Frame("f7", 0), None)
    with pytest.raises(BadInput, match=r"gave tuple, not d3a\.model\.Detection"):
        wrong.detect(Frame("f7", 0), None)


def test_words_of_a_plug_in_are_cleaned_and_its_looks_left_to_the_embedder(site: Path) -> None:
    found = open_detector("escaping")
    assert found is not None
    assert found.classes == ("cu[31mp",)
    (one,) = found.detect(Frame("f", 0), None)
    assert (one.category, one.embedding, one.row) == ("cu[31mp", None, None)


@pytest.mark.parametrize(
    ("name", "said"),
    [("named", "calls itself 'rgb-mine', which is a histogram's"), ("broken", "no method embed")],
)
def test_an_embedder_that_cannot_be(site: Path, name: str, said: str) -> None:
    with pytest.raises(BadInput, match=said):
        open_embedder(name)


def test_two_packages_with_one_name_are_refused(site: Path) -> None:
    install(site, "d3a-crimson")
    with pytest.raises(BadInput, match="two packages have a detector 'red'"):
        open_detector("red")
