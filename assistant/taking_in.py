"""The options of a command that fills a store: what of a recording is taken in, and how."""

from __future__ import annotations

from collections.abc import Callable, MutableMapping
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, TypeVar

import click

from assistant.options import failures

if TYPE_CHECKING:
    from d3a.ingesting.intake import Intake
    from d3a.parameters import Parameters

_Function = TypeVar("_Function", bound=Callable[..., Any])
_OPTIONS = (
    click.option(
        "--format", "format_name", metavar="NAME", help="Reader; by default found by looking."
    ),
    click.option(
        "--reader",
        "reader_options",
        multiple=True,
        metavar="KEY=VALUE",
        help="Tell the reader something, such as depth-scale=1000, times=FILE, poses=FILE, "
        "site=lab.",
    ),
    click.option(
        "--topic", "topics", multiple=True, metavar="NAME=TOPIC", help="Which topic to read."
    ),
    click.option("--profile", default="default", show_default=True, help="default or paper."),
    click.option("--since", metavar="TIME", help="Leave out frames before this ISO time or date."),
    click.option("--every", type=click.IntRange(min=1), default=1, help="Take each N-th frame."),
    click.option(
        "--min-probability", type=click.FloatRange(0, 1), help="Leave weaker detections out."
    ),
    click.option(
        "--ignore",
        multiple=True,
        metavar="CATEGORY",
        help="Never store these things; they are painted over in pictures. Repeatable.",
    ),
    click.option(
        "--off-limits",
        multiple=True,
        metavar="REGION",
        help='Never store what is in this region, or polygon "x,y x,y x,y" in metres. Repeatable.',
    ),
)


def intake_options(function: _Function) -> _Function:
    """Give a command the options of what it takes in; see `Wanted.taken_from`."""
    for option in reversed(_OPTIONS):
        function = option(function)
    return function


@dataclass(frozen=True, slots=True)
class Wanted:
    """What the person wants of a recording, as it stands on the command line."""

    format_name: str | None = None
    reader_options: tuple[str, ...] = ()
    topics: tuple[str, ...] = ()
    profile: str = "default"
    since: str | None = None
    every: int = 1
    min_probability: float | None = None
    ignore: tuple[str, ...] = ()
    off_limits: tuple[str, ...] = ()
    options: dict[str, str] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        from d3a.readers.options import key_values

        with failures():
            topics = (f"topic.{topic}" for topic in self.topics)
            self.options.update(key_values((*self.reader_options, *topics)))

    @classmethod
    def taken_from(cls, wished: MutableMapping[str, Any]) -> Wanted:
        """Take these options out of a command's others."""
        return cls(**{each.name: wished.pop(each.name) for each in fields(cls) if each.init})

    def parameters(self) -> Parameters:
        """Return the profile's parameters with what was asked for."""
        from d3a.parameters import PROFILES

        if self.profile not in PROFILES:
            raise click.BadParameter(
                f"{self.profile!r} is no profile; there are {', '.join(PROFILES)}"
            )
        parameters = PROFILES[self.profile]
        if self.min_probability is not None:
            parameters = parameters.with_changes(min_probability=self.min_probability)
        return parameters

    def intake(self, zone: str | None) -> Intake:
        """Return what goes in; zone: in which a time without an offset is meant."""
        from d3a.ingesting.intake import Intake, off_limits_of
        from d3a.readers.clock import Clock

        return Intake(
            None if self.since is None else Clock(zone).absolute_ms(self.since),
            self.every,
            frozenset(self.ignore),
            tuple(off_limits_of(text) for text in self.off_limits),
        )
