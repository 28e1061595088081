"""Does a recording look like the paper's? Counts and likeness of its embeddings, from its truth."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from d3a.model import Json
from d3a.truth import Truth, read_truth

PAIRS = 200_000


def statistics(folder: Path, seed: int = 0) -> Json:
    """Return the figures by which worlds are compared with the paper's Tables 2 and 4.

    cosines: percentiles over pairs of detections (same object; other object, same true category;
    other category), of raw counts and of their square roots. detections_per_object: mean,
    deviation, most. position_error_m: per axis, against the true centre.
    """
    truth = read_truth(folder)
    per_object = np.array([len(one.detections) for one in truth.objects])
    seen = per_object[per_object > 0]
    real = truth.owner >= 0
    true_category = [truth.objects[k].category if k >= 0 else "" for k in truth.owner]
    confused = np.array(truth.category) != np.array(true_category)
    found: Json = {
        "objects": len(truth.objects),
        "frames": truth.frames,
        "detections": len(truth.owner),
        "detections_per_object": {
            "mean": float(seen.mean()),
            "sd": float(seen.std()),
            "max": int(seen.max()),
            "never": int((per_object == 0).sum()),
            "at_least_10": int((per_object >= 10).sum()),
        },
        "false_positives": float((~real).mean()),
        "confused": float(confused[real].mean()),
        "probability_median": float(np.median(truth.probability)),
        "position_error_m": _position_error(truth),
        "frames_with_detections": len(set(truth.frame)) / max(1, truth.frames),
    }
    path = folder / "embeddings.npy"
    if path.exists():
        found["cosines"] = _cosines(truth, np.load(path), np.random.default_rng(seed))
    return found


def _position_error(truth: Truth) -> list[float]:
    """Return the standard deviation of x, y, z of small things' reported positions."""
    errors = []
    for row in np.flatnonzero(truth.owner >= 0):
        one = truth.objects[truth.owner[row]]
        number = truth.place_of(int(row))
        if number is not None and one.category in ("cup", "bottle", "bowl"):
            errors.append(truth.position[row] - np.array(one.places[number].position))
    return [round(float(v), 3) for v in np.std(errors, axis=0)] if errors else []


def _cosines(truth: Truth, vectors: NDArray[np.float32], rng: np.random.Generator) -> Json:
    real = np.flatnonzero(truth.owner >= 0)
    a, b = rng.choice(real, size=(2, PAIRS))
    same = (truth.owner[a] == truth.owner[b]) & (a != b)
    kinds = np.array([one.category for one in truth.objects])
    alike = kinds[truth.owner[a]] == kinds[truth.owner[b]]
    out: Json = {}
    for name, rows in (("raw", vectors), ("root", np.sqrt(vectors))):
        unit = rows / np.maximum(np.linalg.norm(rows, axis=1, keepdims=True), 1e-12)
        cosine = np.einsum("pd,pd->p", unit[a], unit[b])
        out[name] = {
            "same_object": _percentiles(cosine[same]),
            "other_same_category": _percentiles(cosine[alike & (truth.owner[a] != truth.owner[b])]),
            "other_category": _percentiles(cosine[~alike]),
        }
    return out


def _percentiles(values: NDArray[np.floating]) -> list[float]:
    """Return the 5th, 50th and 95th percentile."""
    return [round(float(v), 3) for v in np.percentile(values, (5, 50, 95))] if len(values) else []
