"""Every threshold of the association and of the answers, in one place."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any, Literal

Profile = Literal["default", "paper"]


@dataclass(frozen=True, slots=True)
class Parameters:
    """The numbers of the paper (Evaluation, "Parameter Selection") and of what goes beyond it.

    The profile chooses operators; the numbers below serve both unless a comment says otherwise.
    """

    profile: Profile = "default"
    # Tier 1
    window_frames: int = 10
    min_frames: int = 2  # a cluster seen in fewer distinct frames is noise (paper profile)
    window_gap_s: float = 60.0  # a longer pause starts a new window
    # Tiers 1 to 3
    min_similarity: float = 0.4  # cosine; the reading "distance" is min_similarity = 0.6
    d_thresh_m: float = 0.5
    # Tier 2
    stm_capacity: int = 400
    # Sightings
    interval_gap_s: float = 600.0  # an interval closes after this long without a view
    max_interval_s: float = 3600.0  # storage limit; longer ones are split and joined on reading
    # Default profile: see d3a/tier2.py for what each weighs
    confirm_sightings: int = 2  # fewer views ever: tentative
    # Ingest
    checkpoint_frames: int = 100
    keyframe_max_side: int = 1280
    keyframe_quality: int = 85
    # Views (coverage)
    view_range_m: float = 5.0
    # Answers
    together_m: float = 1.0
    near_m: float = 1.5

    def with_changes(self, **changes: Any) -> Parameters:
        """Return a copy with some fields changed; an unknown name is a TypeError."""
        return replace(self, **changes)

    def to_json(self) -> dict[str, Any]:
        """Return every field by name, for the store's record of how it was filled."""
        return {f.name: getattr(self, f.name) for f in fields(self)}


DEFAULT = Parameters()
PAPER = Parameters(profile="paper")
PROFILES: dict[str, Parameters] = {"default": DEFAULT, "paper": PAPER}
