"""Colour words against histograms of painted things, in light that the model is not told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from d3a.answering.attributes import LEAST_DOUBTFUL
from d3a.colours import BASIC, Appearances, Palette, Verdict, colours_of, is_colour, learn, terms
from d3a.colours.kinds import kinds_of
from d3a.colours.names import lab, linear, rest_of, table
from d3a.colours.naming import naming
from d3a.colours.pixels import AMONG_MANY, as_shares
from tests.worlds.made import PAINTS, Rgb, painted

WALLS: tuple[Rgb, ...] = ((150, 120, 90), (170, 170, 165), (90, 80, 75), (210, 200, 180))


def judge(
    colours: list[str],
    embeddings: NDArray[np.float32],
    palette: Palette,
    views: NDArray[np.float64] | None = None,
) -> Verdict:
    """Return what is said of histograms (n, 512) that are read anew."""
    return Appearances.of(embeddings, palette, views).judge(colours)


def shop(*, light: float, fill: float) -> tuple[NDArray[np.float32], list[str]]:
    """Return four things of each paint, each paint a little off, before four walls."""
    rng = np.random.default_rng(20)
    rows, names = [], []
    for wall in WALLS:
        for name, paint in PAINTS.items():
            r, g, b = np.clip(np.array(paint) + rng.normal(0, 8, 3), 0, 255)
            rows.append(painted((r, g, b), rng, wall=wall, light=light, fill=fill))
            names.append(name)
    return np.stack(rows), names


@pytest.mark.parametrize("light", [1.0, 0.7, 0.45])
def test_painted_things_get_their_own_colour_in_any_light(light: float) -> None:
    matrix, names = shop(light=light, fill=0.6)
    palette = Palette.of(matrix)
    scores = np.stack([judge([term], matrix, palette).probability for term in BASIC], axis=1)
    best = [BASIC[i] for i in scores.argmax(axis=1)]
    right = sum(a == b for a, b in zip(best, names, strict=True))
    assert right / len(names) >= 0.9
    assert np.allclose(scores.sum(axis=1), 1.0)


@pytest.mark.parametrize("fill", [0.75, 0.6, 0.4])
def test_a_thing_keeps_its_colour_and_refuses_most_others(fill: float) -> None:
    matrix, names = shop(light=0.7, fill=fill)
    palette = Palette.of(matrix)
    tenable = {term: judge([term], matrix, palette).tenable for term in BASIC}
    own = [tenable[name][i] for i, name in enumerate(names)]
    others = [sum(tenable[t][i] for t in BASIC if t != name) for i, name in enumerate(names)]
    assert np.mean(own) >= 0.9
    assert np.mean(others) <= 0.2


def test_one_thing_alone_is_judged_without_others_around() -> None:
    rng = np.random.default_rng(1)
    matrix = painted(PAINTS["red"], rng)[None, :]
    palette = Palette.of(matrix)
    assert judge(["red"], matrix, palette).probability[0] > 0.6
    assert judge(["red"], matrix, palette, np.array([20.0])).probability[0] > 0.9
    assert not judge(["blue"], matrix, palette).tenable[0]


def crockery(
    seed: int = 21, parts_of: tuple[int, int, int] = (4, 2, 4)
) -> tuple[NDArray[np.float32], list[str]]:
    """Return four of each paint, of which shades and pale lids hide about as much as they show.

    parts_of: weights of what is shown, of shade and of lid.
    """
    rng = np.random.default_rng(seed)
    matrix, names = shop(light=0.8, fill=0.6)
    shade, lid = (painted(rgb, rng, light=0.8, fill=0.9) for rgb in ((30, 28, 28), (190, 186, 180)))
    parts = rng.dirichlet(parts_of, size=len(names))
    looks = as_shares(matrix) * parts[:, :1] + parts[:, 1:] @ as_shares(np.stack([shade, lid]))
    return looks.astype(np.float32), names


def right(matrix: NDArray[np.float32], names: list[str], palette: Palette) -> float:
    """Return the share of often seen things that are called by their own colour first."""
    best = Appearances.of(matrix, palette, np.full(len(names), 30.0)).chances.argmax(axis=1)
    return float(np.mean([BASIC[i] == name for i, name in zip(best, names, strict=True)]))


def test_most_of_what_is_seen_of_a_ball_faces_the_light() -> None:
    rng = np.random.default_rng(8)

    def tilted(cosine: NDArray[np.float64]) -> NDArray[np.float64]:
        turn, sine = rng.uniform(0, 2 * np.pi, len(cosine)), np.sqrt(1 - cosine**2)
        return np.stack([sine * np.cos(turn), sine * np.sin(turn), cosine], axis=1)

    seen = tilted(np.sqrt(rng.random(200_000)))  # evenly over the disc
    lamps = tilted(rng.uniform(np.cos(np.radians(30)), 1, 200_000))
    light = 0.1 + np.maximum((seen * lamps).sum(axis=1), 0)
    assert np.quantile(light, np.arange(0.05, 1, 0.1)) == pytest.approx(terms._LIGHTS, abs=0.01)


def test_shades_and_lids_do_not_hide_a_colour() -> None:
    shops = [crockery(seed) for seed in (21, 22, 23)]
    assert np.mean([right(*shop, Palette.of(shop[0])) for shop in shops]) >= 0.82


def test_things_of_a_store_teach_what_its_colours_look_like() -> None:
    shops = [crockery(seed, (3, 2, 5)) for seed in (21, 22, 23)]
    views = np.full(len(shops[0][1]), 30.0)
    learned = np.mean([right(*shop, learn(shop[0], views)) for shop in shops])
    assert learned >= np.mean([right(*shop, Palette.of(shop[0])) for shop in shops]) + 0.02


def test_a_thing_is_judged_by_the_others_not_by_itself() -> None:
    matrix, names = crockery()
    whole = learn(matrix)
    for row in range(0, len(names), 7):
        others = replace(whole, learned=learn(np.delete(matrix, row, axis=0)).learned)
        one = matrix[row][None, :]
        told = Appearances.of(one, whole).chances
        once_more = Appearances.of(one, others)  # as if it were none of those that told
        without = once_more.among(others.learned, np.zeros((1, len(BASIC))))
        assert np.abs(told - without).max() < 0.1


def test_what_is_seen_often_tells_more_of_its_colour() -> None:
    matrix, names = crockery()
    views = np.where(np.array(names) == "red", 30.0, 1.0)
    learned = learn(matrix, views).learned.called
    assert learned[BASIC.index("red")] > 2 * learned[BASIC.index("blue")]


def test_in_a_large_store_the_best_seen_teach() -> None:
    matrix, _ = crockery()
    many = np.tile(matrix, (AMONG_MANY // len(matrix) + 2, 1))
    views = np.where(np.arange(len(many)) < AMONG_MANY, 30.0, 1.0)
    large, teachers = learn(many, views), learn(many[:AMONG_MANY], views[:AMONG_MANY])
    assert large.count == len(many)
    assert large.learned.called.sum() == pytest.approx(AMONG_MANY)
    assert np.allclose(large.learned.called, teachers.learned.called, atol=1.0)


@pytest.mark.parametrize(
    "asked", [["red"], ["gray"], ["dark blue"], ["teal"], ["silver"], ["red", "white"]], ids=str
)
def test_looks_that_were_read_for_another_colour_tell_the_same(asked: list[str]) -> None:
    matrix, names = shop(light=0.7, fill=0.6)
    palette, views = learn(matrix), np.linspace(1.0, 40.0, len(names))
    kept = Appearances.of(matrix, palette, views)
    kept.judge(["green"])
    told, anew = kept.judge(asked), judge(asked, matrix, palette, views)
    assert told.probability.tolist() == anew.probability.tolist()
    assert told.tenable.tolist() == anew.tenable.tolist()
    assert kept.judge(asked).probability.tolist() == anew.probability.tolist()  # and once more


def test_what_is_judged_does_not_depend_on_what_else_is() -> None:
    matrix, _ = shop(light=1.0, fill=0.6)
    palette = Palette.of(matrix)
    matrix[3] = 0.0  # nothing of it was seen
    for colours in (["orange"], ["olive"]):
        together = judge(colours, matrix, palette).probability
        alone = [judge(colours, row[None, :], palette).probability[0] for row in matrix]
        assert np.allclose(together, alone, atol=1e-5)


def test_scale_of_a_histogram_does_not_matter() -> None:
    matrix, _ = shop(light=1.0, fill=0.6)
    palette = Palette.of(matrix)
    one = judge(["green"], matrix, palette).probability
    assert np.allclose(one, judge(["green"], matrix * 7, palette).probability)


@pytest.mark.parametrize(
    ("darker", "lighter"), [("dark blue", "light blue"), ("dark green", "light green")]
)
def test_shades_of_one_colour_are_told_apart(darker: str, lighter: str) -> None:
    rng = np.random.default_rng(3)
    hue = darker.split()[1]
    dark = tuple(0.42 * np.array(PAINTS[hue]))
    pale = tuple(0.5 * np.array(PAINTS[hue]) + 0.5 * 255)
    rest = [painted(paint, rng) for paint in PAINTS.values()]
    matrix = np.stack([painted(dark, rng), painted(pale, rng), *rest])
    palette = Palette.of(matrix)
    one, other = judge([darker], matrix, palette), judge([lighter], matrix, palette)
    assert one.probability[0] > 3 * one.probability[1]
    assert other.probability[1] > 3 * other.probability[0]
    assert one.tenable[0]
    assert other.tenable[1]


def test_a_colour_that_nobody_thought_of_works() -> None:
    rng = np.random.default_rng(4)
    teal, crimson = (10, 125, 125), (150, 10, 45)
    rest = [painted(paint, rng) for paint in PAINTS.values()]
    matrix = np.stack([painted(teal, rng), painted(crimson, rng), *rest])
    palette = Palette.of(matrix)
    for word, row in (("teal", 0), ("crimson", 1)):
        verdict = judge([word], matrix, palette)
        assert int(np.argmax(verdict.probability)) == row
        assert verdict.tenable[row]


def test_red_and_white_wants_both() -> None:
    rng = np.random.default_rng(5)
    half = (painted(PAINTS["red"], rng) + painted(PAINTS["white"], rng)) / 2
    rest = [painted(paint, rng) for paint in PAINTS.values()]
    matrix = np.stack([half, *rest]).astype(np.float32)
    verdict = judge(["red", "white"], matrix, Palette.of(matrix))
    assert int(np.argmax(verdict.probability)) == 0
    assert verdict.tenable[0]
    assert not verdict.tenable[1 + list(PAINTS).index("blue")]


@pytest.mark.parametrize(
    "word",
    [
        "red",
        "gray",
        "Grey",
        "light-blue",
        "navy",
        "navy blue",
        "teal",
        "golden",
        "reddish",
        "beige",
    ],
)
def test_listed_words_are_colours(word: str) -> None:
    assert is_colour(word)


@pytest.mark.parametrize("word", ["wooden", "leather", "dark", "striped", "", "brick", "plastic"])
def test_other_words_are_not(word: str) -> None:
    assert not is_colour(word)
    assert colours_of(word) is None


def test_gray_and_grey_are_one_word() -> None:
    one, other = colours_of("light gray"), colours_of("light-grey")
    assert one is not None
    assert other is not None
    assert np.array_equal(one, other)


def test_a_basic_term_takes_in_the_names_that_end_in_it() -> None:
    blue, dark_blue = colours_of("blue"), colours_of("dark blue")
    assert blue is not None
    assert dark_blue is not None
    assert len(blue) > len(dark_blue) > 1
    both = {tuple(row) for row in dark_blue} & {tuple(row) for row in blue}
    assert len(both) > 0.9 * len(dark_blue)  # but for what a standard calls a dark blue


def test_a_basic_term_is_what_people_call_so() -> None:
    white = colours_of("white")
    assert white is not None
    assert (lab(white)[:, 1:] ** 2).sum(axis=1).max() < 15**2  # no wood in the sun


def test_wood_in_the_light_is_brown_before_it_is_white() -> None:
    rng = np.random.default_rng(6)
    rest = [painted(paint, rng) for paint in PAINTS.values()]
    matrix = np.stack([painted((196.0, 160.0, 124.0), rng), *rest])
    views = np.full(len(matrix), 20.0)
    chances = Appearances.of(matrix, Palette.of(matrix), views).chances[0]
    assert chances[BASIC.index("brown")] > 2 * chances[BASIC.index("white")]


def test_what_is_of_a_colour_in_part_is_not_denied_it() -> None:
    rng = np.random.default_rng(8)
    rest = [painted(paint, rng) for paint in PAINTS.values()]
    blades, handles = (as_shares(painted(PAINTS[p], rng)[None, :])[0] for p in ("white", "red"))
    scissors = np.float32(0.65) * blades + np.float32(0.35) * handles
    matrix = np.stack([scissors.astype(np.float32), *rest])
    looks = Appearances.of(matrix, Palette.of(matrix), np.full(len(matrix), 30.0))
    assert looks.chances[0, BASIC.index("red")] < LEAST_DOUBTFUL  # it is a white thing
    assert looks.judge(["white"]).tenable[0]
    red, green = looks.judge(["red"]), looks.judge(["green"])
    assert red.probability[0] >= LEAST_DOUBTFUL > green.probability[0]
    assert not red.tenable[0]


@pytest.mark.parametrize("exposure", [1.0, 0.6])
def test_every_bin_is_called_something(exposure: float) -> None:
    called = naming(exposure)
    assert called.shape == (len(BASIC), 512)
    assert np.allclose(called.sum(axis=0), 1.0)
    grey = 0b100_100_100  # in half of the light
    assert BASIC[called[:, grey].argmax()] == "grey"
    assert BASIC[called[:, 0].argmax()] == "black"
    assert BASIC[called[:, -1].argmax()] == "white"


def test_a_middle_blue_is_neither_dark_nor_pale_nor_deep() -> None:
    rng = np.random.default_rng(3)
    rest = [painted(paint, rng) for paint in PAINTS.values()]
    matrix = np.stack([painted((42.0, 95.0, 208.0), rng), *rest])
    looks = Appearances.of(matrix, Palette.of(matrix), np.full(len(matrix), 20.0))
    assert looks.judge(["blue"]).probability[0] > 0.9
    for shade in ("dark", "pale", "deep"):
        assert looks.judge([f"{shade} blue"]).probability[0] < 0.5


def test_no_thing_is_surely_dark_and_light_at_once() -> None:
    rng = np.random.default_rng(9)
    paints = [rng.uniform(20, 235, 3) for _ in range(60)]
    matrix = np.stack([painted((r, g, b), rng) for r, g, b in paints])
    looks = Appearances.of(matrix, Palette.of(matrix), np.full(len(matrix), 20.0))
    for term in ("blue", "red", "green", "brown", "grey", "purple"):
        dark, light = (looks.judge([f"{shade} {term}"]).probability for shade in ("dark", "light"))
        assert np.minimum(dark, light).max() < 0.35
        assert np.maximum(dark, light).max() > 0.5


def test_a_shade_without_names_is_as_far_off_as_others_are() -> None:
    (kind,) = kinds_of("pale black")
    assert kind.term == "black"
    assert kind.own[0] > kind.plain[0] + 10  # lighter
    assert kinds_of("blue") == kinds_of("teal") == kinds_of("very dark blue") == ()


def test_silver_is_said_of_light_greys_and_not_of_what_is_white_or_dark() -> None:
    rng = np.random.default_rng(4)
    greys = [painted((v, v, v), rng) for v in (35.0, 100.0, 185.0, 245.0)]
    rest = [painted(paint, rng) for paint in PAINTS.values()]
    matrix = np.stack([*greys, *rest])
    looks = Appearances.of(matrix, Palette.of(matrix), np.full(len(matrix), 20.0))
    dark, middle, light, white = looks.judge(["silver"]).probability[:4]
    assert light > max(2 * dark, 1.2 * middle, 2 * white)


def test_an_empty_store_has_a_palette() -> None:
    palette = Palette.of(np.zeros((0, 512), dtype=np.float32))
    assert palette.count == 0
    assert palette.exposure == 1.0


def test_polished_metal_mirrors_dark_and_bright() -> None:
    rng = np.random.default_rng(3)
    shiny = np.mean([painted(rgb, rng) for rgb in ((25, 25, 27), (110, 110, 112), (210,) * 3)], 0)
    matrix = np.stack([shiny, *(painted(PAINTS[p], rng) for p in ("white", "black", "red"))])
    verdict = judge(["silver"], matrix.astype(np.float32), Palette.of(matrix))
    assert verdict.tenable.tolist() == [True, False, False, False]


@pytest.mark.parametrize(
    ("colour", "base"),
    [
        ("crimson", "red"),
        ("maroon", "red"),
        ("ivory", "white"),
        ("navy", "blue"),
        ("beige", "white"),
        ("charcoal", "grey"),
        ("tan", "brown"),
        ("olive", "green"),
    ],
)
def test_a_name_of_its_own_is_among_a_basic_colour(colour: str, base: str) -> None:
    rest = rest_of(colour)
    assert rest is not None
    assert rest[0] == base
    own = colours_of(colour)
    assert own is not None
    apart = np.linalg.norm(rest[1][:, None, :] - own[None, :, :], axis=2).min(axis=1)
    assert (apart > 0.01).all()  # nothing like it is left among its rivals


def test_a_basic_term_is_among_none() -> None:
    assert all(rest_of(term) is None for term in BASIC)


@pytest.mark.parametrize("said", ["{}", "{}-coloured"])
def test_every_listed_name_is_a_colour_as_people_and_style_sheets_write_it(said: str) -> None:
    made_of = {"brick", "cement", "clay", "dark", "denim", "leather", "linen", "pale", "steel"}
    made_of |= {"stone", "straw", "velvet"}
    names = {" ".join(name) for name in table().names}
    glued = {name.replace(" ", "") for name in names}
    spelled = names | glued | {name.replace("grey", "gray") for name in names | glued}
    unknown = {name for name in spelled if not is_colour(said.format(name))}
    assert unknown <= (made_of if said == "{}" else {"dark", "pale"})


@pytest.mark.parametrize(
    ("said", "listed"),
    [
        ("pinkish brown", (177, 114, 97)),
        ("golden yellow", (254, 198, 21)),
        ("blue/grey", (117, 141, 163)),
        ("LightGoldenrodYellow", (250, 250, 210)),
        ("burnt-sienna", (176, 78, 15)),
    ],
)
def test_a_listed_name_is_the_colour_that_the_list_has(
    said: str, listed: tuple[int, int, int]
) -> None:
    colours = colours_of(said)
    assert colours is not None
    assert np.abs(colours - linear(np.array(listed, float))).max(axis=1).min() < 1e-9
