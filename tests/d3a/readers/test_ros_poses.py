"""The tf tree and topics of poses: between two samples, along chains, and where they break off."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest

from d3a.geometry import rotation
from d3a.model import BadInput, Pose
from d3a.readers import ros_tf
from d3a.readers.base import Link
from d3a.readers.ros_poses import PoseTopic, Way, covariance_of, find_way, mount_of, moved
from d3a.readers.ros_tf import OPTICAL, Reach, Samples, Tree, composed

SECOND = 10**9
REACH = Reach(1.2 * SECOND, 0.5 * SECOND)
Q90 = (0.0, 0.0, math.sin(math.pi / 4), math.cos(math.pi / 4))


def at(x: float, y: float = 0.0, turn: Sequence[float] = (0, 0, 0, 1)) -> Pose:
    return Pose((x, y, 0.0), (turn[0], turn[1], turn[2], turn[3]))


def tree_of(*links: tuple[str, str, int | None, Pose]) -> Tree:
    tree = Tree()
    for parent, child, time_ns, pose in links:
        tree.add(parent, child, time_ns, pose)
    return tree


def way(tree: Tree, topics: Sequence[PoseTopic] = (), **told: object) -> Way:
    found = find_way(tree, topics, ["cam"], told.get("wanted"), bool(told.get("told")))  # type: ignore[arg-type]
    assert isinstance(found, Way), found
    return found


def topic(name: str, parent: str, child: str, samples: Sequence[tuple[int, Pose]]) -> PoseTopic:
    made = PoseTopic(name, "nav_msgs/msg/Odometry", parent, child)
    for time_ns, pose in samples:
        made.samples.add(time_ns, (*pose.position, *pose.quaternion))
    return made


def test_between_two_samples_the_turn_runs_on_the_sphere() -> None:
    samples = Samples()
    for time_ns, pose in ((SECOND, at(1, turn=Q90)), (0, at(0))):  # in any order
        samples.add(time_ns, (*pose.position, *pose.quaternion))
    quarter = samples.at(SECOND // 4, REACH)
    assert quarter is not None
    assert quarter.position == pytest.approx((0.25, 0, 0))
    angle = 2 * math.atan2(quarter.quaternion[2], quarter.quaternion[3])
    assert angle == pytest.approx(math.pi / 8)


def test_beyond_the_gap_nothing_is_said() -> None:
    samples = Samples()
    for time_ns in (0, SECOND, 5 * SECOND):
        samples.add(time_ns, (time_ns / SECOND, 0, 0, 0, 0, 0, 1))
    found = {t: samples.at(int(t * SECOND), REACH) for t in (-0.6, -0.5, 0.3, 1.4, 2, 4.5, 5.6)}
    assert {t: None if p is None else p.position[0] for t, p in found.items()} == {
        -0.6: None,
        -0.5: 0.0,  # it stands still for that long, and goes nowhere it was not seen to go
        0.3: pytest.approx(0.3),
        1.4: 1.0,
        2: None,
        4.5: 5.0,
        5.6: None,
    }


def test_a_repeated_time_counts_once_the_last_said() -> None:
    samples = Samples()
    for time_ns, x in ((0, 1.0), (0, 2.0), (9, 3.0), (0, 4.0)):
        samples.add(time_ns, (x, 0, 0, 0, 0, 0, 1))
    first = samples.at(0, REACH)
    assert first is not None
    assert first.position[0] == 4.0


def test_composition_is_that_of_matrices() -> None:
    rng = np.random.default_rng(7)
    for _ in range(50):
        a, b = (Pose(tuple(rng.normal(size=3)), tuple(rng.normal(size=4))) for _ in range(2))
        both = composed(a, b)
        assert rotation(both) == pytest.approx(rotation(a) @ rotation(b))
        assert both.position == pytest.approx(rotation(a) @ b.position + np.array(a.position))
        assert both.quaternion[3] >= 0


def test_the_chain_runs_from_the_map_to_the_camera() -> None:
    tree = tree_of(
        ("map", "odom", 0, at(10)),
        ("odom", "base_link", 0, at(1, turn=Q90)),
        ("odom", "base_link", SECOND // 2, at(2, turn=Q90)),
        ("base_link", "mast", None, at(0.5)),
        ("mast", "cam", None, OPTICAL),
        ("base_link", "wheel", 0, at(9)),
    )
    found = way(tree)
    pose = found.at(SECOND // 4, REACH)
    assert pose is not None
    assert pose.position == pytest.approx((11.5, 0.5, 0))
    ahead, down = rotation(pose)[:, 2], rotation(pose)[:, 1]
    assert ahead == pytest.approx(np.array([0, 1, 0]))  # the robot looks along the map's y
    assert down == pytest.approx(np.array([0, 0, -1]))
    assert found.at(2 * SECOND, REACH) is None
    assert found.missing(2 * SECOND, REACH) == "map -> odom"
    assert Link("mast", "cam", True, 1) in tree.links()


def test_circles_end_and_the_parent_told_most_often_counts() -> None:
    tree = tree_of(
        ("a", "cam", 0, at(1)),
        ("a", "cam", 1, at(1)),
        ("b", "cam", 0, at(2)),
        ("cam", "a", 0, at(0)),
    )
    assert [edge.parent for edge in tree.way_up("cam")] == ["a", "cam"]
    assert tree.disputed() == ["cam"]


def test_links_aside_of_the_camera_are_let_go(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ros_tf, "MOST_ASIDE", 10)
    tree = tree_of(("base_link", "cam", None, at(0)))
    for n in range(20):
        tree.add("base_link", "wheel", n, at(n))
        tree.add("map", "odom", n, at(n))
        tree.add("odom", "base_link", n, at(n))
    tree.prune(["cam"], {})
    kept = {edge.child: len(edge.samples) for edge in tree._edges.values()}
    assert kept == {"cam": 0, "wheel": 0, "odom": 20, "base_link": 20}
    assert {link.child: link.count for link in tree.links()}["wheel"] == 20


def test_odometry_is_a_link_where_tf_has_none() -> None:
    tree = tree_of(("base_link", "cam", None, OPTICAL), ("map", "odom", None, at(5)))
    odometry = topic("/odom", "odom", "base_link", [(0, at(1)), (SECOND, at(2))])
    found = way(tree, [odometry])
    pose = found.at(SECOND // 2, REACH)
    assert pose is not None
    assert pose.position == pytest.approx((6.5, 0, 0))
    assert pose.quaternion == pytest.approx(OPTICAL.quaternion) or pose.quaternion == pytest.approx(
        [-q for q in OPTICAL.quaternion]
    )
    assert (found.top, found.notes) == ("map", ())


def test_poses_in_odom_are_said_to_drift() -> None:
    tree = tree_of(("odom", "base_link", 0, at(1)), ("base_link", "cam", None, OPTICAL))
    found = way(tree)
    assert found.top == "odom"
    assert "drifts" in found.notes[0]


def test_a_pose_in_the_map_goes_before_odometry() -> None:
    tree = tree_of(("odom", "base_link", 0, at(1)), ("base_link", "cam", None, OPTICAL))
    amcl = topic("/amcl_pose", "map", "", [(0, at(7))])
    found = way(tree, [amcl, topic("/odom", "odom", "base_link", [(0, at(1))])])
    pose = found.at(0, REACH)
    assert pose is not None
    assert (found.top, pose.position) == ("map", (7.0, 0.0, 0.0))


def test_without_a_mount_the_robot_looks_ahead_and_that_is_said() -> None:
    found = way(Tree(), [topic("/odom", "odom", "base_link", [(0, at(1))])])
    pose = found.at(0, REACH)
    assert pose is not None
    assert rotation(pose)[:, 2] == pytest.approx(np.array([1, 0, 0]))
    assert any("looking ahead" in note for note in found.notes)
    own = way(Tree(), [topic("/slam", "map", "cam_optical", [(0, at(1))])])
    assert (own.mount, own.notes) == (None, ())


def test_two_topics_of_poses_are_asked_about() -> None:
    tree = tree_of(("base_link", "cam", None, OPTICAL))
    two = [topic(n, "odom", "base_link", [(0, at(1))]) for n in ("/odom", "/wheel_odom")]
    with pytest.raises(BadInput, match=r"/odom .* /wheel_odom .*--topic pose=/odom"):
        way(tree, two)
    assert way(tree, two[1:], told=True).edges[0].child == "base_link"


def test_no_way_is_said_in_a_sentence() -> None:
    said = find_way(tree_of(("base_link", "cam", None, OPTICAL)), [], ["cam"], None, False)
    assert said == "no transform leads from map to the camera (cam)"
    moving = tree_of(("odom", "cam", 0, at(1)))
    with pytest.raises(BadInput, match="'world' is not above the camera's: cam <- odom"):
        find_way(moving, [], ["cam"], "world", False)


def test_covariance_is_that_of_poses_in_the_same_frame() -> None:
    tree = tree_of(
        ("map", "base_link", 0, at(0)),
        ("map", "base_link", SECOND, at(0)),
        ("base_link", "cam", None, at(2)),
    )
    amcl = topic("/amcl_pose", "map", "base_link", [(0, at(0))])
    amcl.times.extend([0, SECOND])
    variances = (0.01, 0.01, 0.0, 0.0, 0.0, 0.04)
    amcl.covariances += [tuple(np.diag(variances).ravel().tolist()), None]
    other = topic("/odom", "odom", "base_link", [(0, at(0))])
    other.times.append(0)
    other.covariances.append(tuple(np.eye(6).ravel().tolist()))
    found = way(tree, [amcl, other])
    pose = found.at(SECOND // 2, REACH)
    assert pose is not None
    assert pose.covariance is not None
    got = np.reshape(pose.covariance, (6, 6))
    # 2 m ahead of the robot its turning error is a sideways one
    assert got.diagonal().tolist() == pytest.approx([0.01, 0.01 + 4 * 0.04, 0, 0, 0, 0.04])
    later = found.at(SECOND, REACH)
    assert later is not None
    assert later.covariance is None


def test_covariances_that_say_nothing_are_none() -> None:
    planar = np.diag([0.1, 0.1, 1e6, 1e6, 1e6, 0.2])
    planar[2, 0] = planar[0, 2] = 3.0
    found = covariance_of(planar.ravel())
    assert found is not None
    assert np.reshape(found, (6, 6)).tolist() == np.diag([0.1, 0.1, 0, 0, 0, 0.2]).tolist()
    nothing = [np.zeros(36), np.full(36, np.nan), np.diag([-1.0, 0, 0, 0, 0, 0]), np.eye(6) * 1e9]
    beyond = np.diag([0.01, 0.01, 0, 0, 0, 0.1])
    beyond[0, 1] = beyond[1, 0] = 0.05  # more shared than either has
    assert [covariance_of(np.ravel(each)) for each in (*nothing, beyond)] == [None] * 5


def test_moved_covariances_stay_symmetric() -> None:
    rng = np.random.default_rng(3)
    root = rng.normal(size=(6, 6))
    got = np.reshape(moved(tuple((root @ root.T).ravel()), at(0), at(1, 2)), (6, 6))
    assert got == pytest.approx(got.T)
    assert np.linalg.eigvalsh(got).min() > -1e-9


@pytest.mark.parametrize("text", ["1,2,3", "0,0,0,0,0,0,nan", "a,b,c,d,e,f,g"])
def test_a_mount_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(BadInput, match="mount"):
        mount_of(text)
    assert mount_of("1,2,3,0,0,0,1").position == (1, 2, 3)
