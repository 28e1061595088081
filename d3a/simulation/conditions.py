"""What is turned up or down in a simulated recording; the world itself stays the seed's."""

from __future__ import annotations

from dataclasses import dataclass, replace

from d3a.model import BadInput


@dataclass(frozen=True, slots=True)
class Condition:
    """Noise of the robot and its sensor; the defaults are the paper's robot ("nominal").

    pose_m: error per axis of the reported pose, standard deviation in metres, split by variance
    into independent, 90 s and 1 h parts (pose_shares). heading_deg: the same split, about the up
    axis. claimed_pose_m: what the robot says of itself in `pose_covariance`; it does not know
    better than the paper's half metre, unless its sensor is a perfect one.
    depth: error relative to the range. confusion, false_positives: shares of the detections.
    colour: factor on every change of look (light, background, shadow).
    skewed: whether an object has a typical detection probability of its own.
    even_patrol: rounds through all way points instead of favourite ones.
    codes: one-hot instance codes instead of histograms, bits flipped by fpr and fnr (Exp 1).
    perfect: categories and boxes as annotated, no false positive (D3A+P).
    certain: it is sure of everything it says (probability 1).
    """

    name: str = "nominal"
    pose_m: float = 0.35
    pose_shares: tuple[float, float, float] = (0.15, 0.60, 0.25)
    heading_deg: float = 3.0
    claimed_pose_m: float = 0.35
    depth: float = 0.04
    confusion: float = 0.08
    false_positives: float = 0.04
    colour: float = 1.0
    skewed: bool = True
    even_patrol: bool = False
    codes: bool = False
    fpr: float = 0.0
    fnr: float = 0.0
    perfect: bool = False
    certain: bool = False


NOMINAL = Condition()
CONDITIONS: dict[str, Condition] = {
    condition.name: condition
    for condition in (
        NOMINAL,
        Condition("colour-x2", colour=2.0),
        Condition("pose-0.2", pose_m=0.2),
        Condition("pose-0.5", pose_m=0.5),
        Condition("confusion-20", confusion=0.20),
        Condition("false-positives-15", false_positives=0.15),
        Condition("drift", pose_m=0.5, pose_shares=(0.10, 0.25, 0.65)),
        Condition("flat", skewed=False),
        Condition("even-patrol", even_patrol=True),
        Condition(
            "noiseless",
            pose_m=0.0,
            heading_deg=0.0,
            claimed_pose_m=0.05,
            depth=0.0,
            confusion=0.0,
            false_positives=0.0,
            colour=0.0,
        ),
        Condition("perfect", codes=True, perfect=True, certain=True),
        Condition(
            "perfect-0.1",
            pose_m=0.1,
            heading_deg=0.5,
            claimed_pose_m=0.1,
            codes=True,
            perfect=True,
            certain=True,
        ),
    )
}


def named(condition: str | Condition) -> Condition:
    """Return a condition by its name; raises BadInput with the names that exist."""
    if isinstance(condition, Condition):
        return condition
    if condition not in CONDITIONS:
        raise BadInput(f"no condition {condition!r}; there are {', '.join(CONDITIONS)}")
    return CONDITIONS[condition]


def codes(fpr: float, fnr: float = 0.05) -> Condition:
    """Return Exp 1's synthetic embedding generator at one false positive rate.

    Pose noise and the detector's probabilities stay; categories are the annotated ones.
    """
    return replace(CONDITIONS["perfect"], name=f"codes-{fpr:g}", certain=False, fpr=fpr, fnr=fnr)
