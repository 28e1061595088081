"""An embedding that is nothing like the histograms that the look model begins with."""

from __future__ import annotations

import numpy as np
import pytest

from d3a.ingest import ingest
from d3a.model import Detection, Frame, Pose
from d3a.parameters import DEFAULT
from d3a.readers.base import RecordingFacts
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import CAMERA, FORWARD, START_MS, ListReader

CATEGORIES = ("cup", "bowl", "bottle")
PLACES = [(2.0 * k, 2.0 * row, 0.0) for row in range(3) for k in range(4)]
"""Of the things: far enough from each other for place and category to say what is what."""
UNCERTAIN = tuple((np.eye(6) * 0.01).ravel().tolist())


def shown(own: float, frames: int, seed: int) -> list[Frame]:
    """Frames of four of the things each; looks are noise but for a share of each one's own."""
    rng = np.random.default_rng(seed)
    pose = Pose((0.0, -3.0, 0.0), FORWARD, UNCERTAIN)
    looks = rng.normal(size=(len(PLACES), 64))
    out = []
    for n in range(frames):
        seen = []
        for turn, k in enumerate(rng.choice(len(PLACES), 4, replace=False).tolist()):
            x, y, z = (np.array(PLACES[k]) + rng.normal(0, 0.08, 3)).tolist()
            look = own * looks[k] + (1 - own) * rng.normal(size=64)
            box = (12.0 * turn, 10.0, 12.0 * turn + 8.0, 30.0)
            unit = (look / np.linalg.norm(look)).astype(np.float32)
            seen.append(Detection(CATEGORIES[k % 3], 0.9, box, (x, y, z), embedding=unit))
        out.append(Frame(f"f{n}", START_MS + 5000 * n, pose, CAMERA, None, None, tuple(seen)))
    return out


@pytest.mark.parametrize("own", [0.0, 0.3, 0.8])
def test_things_are_found_again_whatever_the_embedding_is_worth(own: float) -> None:
    """Once it is known how alike views are: hardly one in forty is then taken for a new thing."""
    frames = shown(own, 300, seed=1)
    facts = RecordingFacts("made", zone="UTC", embedding_model="strange")
    store = OracleStore()
    ingest(ListReader(frames, facts), store, DEFAULT)
    late_ms = frames[100].time_ms
    new = sum(record.first_ms >= late_ms for record in store.objects())
    assert new <= 0.025 * 4 * 200
