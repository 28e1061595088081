"""Every threshold of the association and of the answers, in one place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, Literal

Profile = Literal["default", "paper"]
Clustering = Literal["components", "dbscan"]
Nearness = Literal["space", "look"]
Weighing = Literal["probability", "count"]
Normalising = Literal["map", "space", "none"]

ANSWER_FIELDS = ("together_m", "near_m")
"""Read when a question is answered: a store filled with other values of these is the same."""


@dataclass(frozen=True, slots=True)
class Parameters:
    """The numbers of the paper (Evaluation, "Parameter Selection") and of what goes beyond it.

    The profile chooses operators; the numbers below serve both unless a comment says otherwise.
    Log-odds are natural logarithms; each says which odds it stands for.
    """

    profile: Profile = "default"
    # What is taken in: weaker detections are left out; None: what the reader advises
    min_probability: float | None = None
    own_pixels: bool = True  # of a picture's box the thing's own colours; False: all of them
    # Tier 1
    window_frames: int = 10
    min_frames: int = 2  # a cluster seen in fewer distinct frames is noise (paper profile)
    window_gap_s: float = 60.0  # a longer pause starts a new window
    clustering: Clustering = "components"  # equal to "dbscan" with two samples, and 5 x quicker
    double_box_iou: float = 0.7  # boxes that share this much are one thing named twice (default)
    # Tiers 1 to 3
    min_similarity: float = 0.4  # cosine; the reading "distance" is min_similarity = 0.6
    d_thresh_m: float = 0.5
    # Tiers 1 to 3, paper profile: what the paper leaves open, with what else it may mean
    weigh_by: Weighing = "probability"  # what a view counts in every mean; or each one alike
    nearest_by: Nearness = "space"  # which of nearIDs is "closest"; by look there are more places
    gate_category: bool = True  # in tiers 2 and 3 as in tier 1; without it ids mix categories
    keep_moved_id: bool = True  # case 2; False: what turns up elsewhere is another thing
    normalise_by: Normalising = "map"  # the axes of tier 3's "normalized Euclidean distance"
    # Tier 2
    stm_capacity: int = 400
    # Where things are: what is assumed where the recording does not say it
    pose_sigma_m: float = 0.35  # per axis: the paper's 0.5 m of pose error in the plane
    pose_tau_s: float = 90.0  # a localisation's error drifts: after this long it is another one
    position_sigma_m: float = 0.15  # of a given position beside the pose: box, surface, rounding
    depth_sigma_rel: float = 0.02  # of the range; stereo and structured light err by 1 to 4 %
    object_spread_m: float = 0.1  # the measured point wanders over the thing's surface
    no_depth_range_m: float = 2.5  # without depth a thing is somewhere before the camera: half way
    noise_prior: float = 50.0  # matches for which the claimed noise counts against what is seen
    noise_least: float = 0.1  # and the smallest share of it that is believed
    noise_gate: float = 12.0  # squared sigmas; what is farther off tells of mistakes, not of noise
    # Default profile, tier 2: log-likelihood ratios against "a thing not seen before"
    space_m3: float = 30.0  # of a home (80 m2 x 2.5 m) for each thing in view not seen yet
    beside_m3: float = 1.0  # the same beside a known thing, before any neighbours were seen,
    beside_prior: float = 20.0  # and the number of things seen for which that counts
    outlier_dof: float = 5.0  # Student's t: depth through a chair's back, localisation that lags
    # Likeness is the cosine of square-root histograms (Bhattacharyya). What is expected of views of
    # one thing and of two, and how much that varies, before anything was learned; and for how many
    # pairs that counts. Then the bounds: no look alone may outvote place and name together.
    look_same: float = 0.78
    look_other: float = 0.42
    look_beside: float = 0.65  # of two that stand side by side: both boxes show the same table
    look_sigma: float = 0.16
    look_prior: float = 30.0
    look_memory: float = 400.0  # pairs after which the oldest fade, as what is compared improves
    space_prior: float = 60.0  # views for which all parts of a look count alike
    look_most: float = 4.0
    look_least: float = -12.0
    plain_odds: float = 2.0  # from here on place and category alone say what a thing is,
    sure_odds: float = 5.0  # and from here on (150 to 1) where the look is not to be trusted yet
    confusion: float = 0.08  # share of detections that carry a wrong category
    category_prior: float = 2.0  # pseudo-counts with which a category's frequency starts,
    category_kinds: float = 20.0  # as if so many kinds of things were about
    gate_sigmas: float = 5.0  # what is farther off than this is not compared
    looks_remembered: float = 30.0  # a look is the mean of about so many views; light changes
    new_thing_odds: float = 0.0  # log-odds of "new" against "known", all else equal
    confirm_sightings: int = 2  # fewer views ever: tentative
    merge_odds: float = 1.0  # log-odds (3 to 1) from which two things of one place are one
    # Default profile, tier 3: negative evidence, expiry, moves
    view_margin: float = 0.1  # share of the picture's edge where a missing box proves nothing
    detect_chance: float = 0.6  # of a present thing in one look, before anything is known of it
    absent_odds: float = 3.0  # log-odds (20 to 1) at which a place counts as seen empty
    seen_through_m: float = 0.3  # depth this far behind a thing's place: it is not there
    expire_odds: float = 2.0  # log-odds (7 to 1) of its absence at which a tentative thing goes
    doubt_odds: float = 1.0  # the same by depth at its only sighting, once its interval is closed
    move_odds: float = -3.5  # log-odds that what turned up is any of its category, moved,
    alike_odds: float = -3.0  # and that it is a certain one whose look tells it from all others
    move_probability: float = 0.95  # from here on a move is linked
    # Sightings
    interval_gap_s: float = 600.0  # an interval closes after this long without a view
    unbroken_gaps: float = 5.0  # default: nor by a pause of so many, while no look saw it gone
    max_interval_s: float = 3600.0  # storage limit; longer ones are split and joined on reading
    # Ingest
    checkpoint_frames: int = 100
    keyframe_max_side: int = 1280
    keyframe_quality: int = 85
    # Views (coverage)
    view_range_m: float = 5.0
    view_step_m: float = 0.5  # a view goes on while the camera moves and turns less than this
    view_turn_rad: float = 0.26  # 15 degrees
    # Answers
    together_m: float = 1.0
    near_m: float = 1.5

    @property
    def unbroken_gap_s(self) -> float:
        """A pause that does not close an interval while no look saw the thing gone."""
        return self.interval_gap_s * self.unbroken_gaps

    def with_changes(self, **changes: Any) -> Parameters:
        """Return a copy with some fields changed; an unknown name is a TypeError."""
        return replace(self, **changes)

    def to_json(self) -> dict[str, Any]:
        """Return every field by name, for the store's record of how it was filled."""
        return {f.name: getattr(self, f.name) for f in fields(self)}

    def differences(self, recorded: Mapping[str, Any]) -> list[str]:
        """Return the names of the fields that fill a store otherwise than `recorded` did."""
        return [
            f.name
            for f in fields(self)
            if f.name not in ANSWER_FIELDS
            and recorded.get(f.name, f.default) != getattr(self, f.name)
        ]


DEFAULT = Parameters()
PAPER = Parameters(profile="paper", own_pixels=False, interval_gap_s=1800.0)
"""The paper does not say when a time interval ends. It never concludes that a thing is gone, so an
interval goes on over half an hour, as the default profile's do over `unbroken_gap_s` while no look
saw the thing gone; ten minutes would store 2.4 keyframes a place, where the paper's Q1 at Any
returns one."""
PROFILES: dict[str, Parameters] = {"default": DEFAULT, "paper": PAPER}


def parameters_of(known: Any) -> Parameters:
    """Return the parameters that a store's meta has; those of a later version are left out."""
    if not isinstance(known, dict):
        return DEFAULT
    base = PROFILES.get(str(known.get("profile")), DEFAULT)
    fields = base.to_json().keys()
    return base.with_changes(**{name: known[name] for name in fields if name in known})
