"""`d3a place`: named rooms, and the floor plan that they lie on."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from assistant import completing
from assistant.exits import ExitCode
from assistant.options import opened, settings_of, settings_options
from assistant.terminal import emit, table
from assistant.told import SCHEMA, carry_out

if TYPE_CHECKING:
    from d3a.constraints import Correction
    from d3a.model import Json
    from d3a.store.base import Region, Store

Corner = tuple[float, float]
json_option = click.option("--json", "as_json", is_flag=True, help="The record of it, as JSON.")


def _corners(
    context: click.Context, parameter: click.Parameter, value: str | None
) -> tuple[Corner, ...] | None:
    """Read corners as "x,y x,y ..."; anything else is a usage error that says how to write them."""
    if value is None:
        return None
    corners = []
    for pair in value.replace(";", " ").split():
        try:
            x, y = map(float, pair.split(","))
        except ValueError:
            message = f'{pair!r} is no corner: write "x,y x,y x,y"'
            raise click.BadParameter(message, ctx=context, param=parameter) from None
        corners.append((x, y))
    return tuple(corners)


@click.group("place")
def command() -> None:
    """Name the rooms of the home, and keep its floor plan."""


@command.command("add")
@click.argument("name")
@click.option("--polygon", callback=_corners, help='Corners in metres of the map: "x,y x,y x,y".')
@click.option(
    "--pixels", callback=_corners, help="Corners in pixels of the imported map's picture."
)
@click.option("--around", callback=_corners, metavar="X,Y", help="A circle around a point, metres.")
@click.option("--here", is_flag=True, help="A circle around the robot, where it stood last.")
@click.option("--radius", type=float, default=1.5, show_default=True, help="Of a circle, metres.")
@click.option("--replace", is_flag=True, help="Draw a place of that name anew.")
@json_option
@settings_options
@click.pass_context
def add(
    context: click.Context,
    name: str,
    polygon: tuple[Corner, ...] | None,
    pixels: tuple[Corner, ...] | None,
    around: tuple[Corner, ...] | None,
    here: bool,
    radius: float,
    replace: bool,
    as_json: bool,
) -> None:
    """Name a place: by its corners, or a circle around a point or the robot."""
    given = [each for each in (polygon, pixels, around, here or None) if each is not None]
    if len(given) != 1:
        raise click.UsageError("say one of --polygon, --pixels, --around and --here")
    if around is not None and len(around) != 1:
        raise click.UsageError("--around takes one point: x,y")

    def act(store: Store, at_ms: int) -> Correction:
        from d3a.teaching import name_place

        return name_place(
            store,
            name,
            polygon=polygon if pixels is None else _metres(store, pixels),
            around=around[0] if around else None,
            radius_m=radius,
            replace=replace,
            at_ms=at_ms,
        )

    carry_out(context, act, as_json=as_json, create=True)


def _metres(store: Store, pixels: tuple[Corner, ...]) -> tuple[Corner, ...]:
    from d3a.floor_map import stored_map
    from d3a.model import BadInput

    floor = stored_map(store)
    if floor is None:
        raise BadInput("pixels are those of a map: d3a place import map.yaml comes first")
    return tuple(floor.of_pixel(u, v) for u, v in pixels)


@command.command("list")
@click.option("--json", "as_json", is_flag=True, help="A JSON object a line.")
@settings_options
@click.pass_context
def list_places(context: click.Context, as_json: bool) -> None:
    """List the named places: corners, size, and how many objects were seen there last."""
    from d3a.answering.places import room_of

    settings = settings_of(context)
    with opened(settings) as store:
        regions = store.regions()
        newest = {stay.object_id: stay for stay in sorted(store.stays(), key=lambda s: s.last_ms)}
    rooms = [room_of(regions, stay.position, stay.site) for stay in newest.values()]
    records = [_record(region, rooms.count(region.name)) for region in regions]
    if as_json:
        for record in records:
            emit(record)
    elif records:
        rows = [["name", "m2", "x", "y", "corners", "objects"]]
        for record in records:
            xs, ys = zip(*record["polygon"], strict=True)
            spans = [f"{min(v):.1f} to {max(v):.1f}" for v in (xs, ys)]
            size = [f"{record['area_m2']:.1f}", *spans, str(len(xs)), str(record["objects"])]
            rows.append([record["name"], *size])
        click.echo("\n".join(table(rows)))
    elif not settings.quiet:
        click.echo("no place has a name: d3a place add", err=True)
    if not records:
        context.exit(ExitCode.NOTHING)


def _record(region: Region, objects: int) -> Json:
    from d3a.answering.places import area_m2

    return {
        "schema": SCHEMA,
        "name": region.name,
        "polygon": [[round(x, 3), round(y, 3)] for x, y in region.polygon],
        "site": region.site,
        "area_m2": round(area_m2(region.polygon), 2),
        "objects": objects,
    }


@command.command("remove")
@click.argument("name", shell_complete=completing.places)
@json_option
@settings_options
@click.pass_context
def remove(context: click.Context, name: str, as_json: bool) -> None:
    """Take a named place away; the next recording does not bring it back."""
    from d3a.teaching import remove_place

    carry_out(context, lambda store, at_ms: remove_place(store, name, at_ms=at_ms), as_json=as_json)


@command.command("rename")
@click.argument("name", shell_complete=completing.places)
@click.argument("new")
@json_option
@settings_options
@click.pass_context
def rename(context: click.Context, name: str, new: str, as_json: bool) -> None:
    """Call a named place otherwise."""
    from d3a.teaching import rename_place

    carry_out(
        context, lambda store, at_ms: rename_place(store, name, new, at_ms=at_ms), as_json=as_json
    )


@command.command("import")
@click.argument("yaml", type=click.Path(path_type=Path), metavar="MAP.YAML")
@json_option
@settings_options
@click.pass_context
def import_map(context: click.Context, yaml: Path, as_json: bool) -> None:
    """Keep the floor plan of a ROS map_server (yaml and its picture) for the chat's map."""

    def act(store: Store, at_ms: int) -> Correction:
        from d3a.floor_map import read_map
        from d3a.teaching import put_map

        floor = read_map(yaml)
        rows, columns = floor.cells.shape
        size = f"{columns * floor.resolution:.1f} x {rows * floor.resolution:.1f} m"
        said = f"{yaml.name} is the floor plan, {size} in cells of {floor.resolution:g} m"
        return put_map(store, floor.to_json(), said, at_ms=at_ms)

    carry_out(context, act, as_json=as_json, create=True)
