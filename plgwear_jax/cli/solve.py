"""The command `plgwear solve`: the quantities that a scene asks for."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from plgwear_jax.cli.computing import computing
from plgwear_jax.cli.question import AsJson, SceneFile, doubt_units, read_scene, refusing_scene
from plgwear_jax.cli.terminal import console, measure, print_json, refuse, table_of

if TYPE_CHECKING:
    from plgwear_jax.scene import Quantity

__all__ = ["solve"]


def solve(
    scene_file: SceneFile,
    as_json: AsJson = False,
    digits: Annotated[
        int | None,
        typer.Option(
            min=1, max=15, help="Correct digits wanted; fewer run faster. By default all.", show_default=False
        ),
    ] = None,
) -> None:
    """Compute the quantities that a scene asks for under [output], or all single numbers if it has no such section.

    Of a function of the radius the table gives the largest value. If it is infinite at an edge, the table says so and
    gives the value at a distance inside the edge: distance under [output], else that of the limit of the edge pressure
    under [design], else a hundredth of the contact radius. --json gives all values.

    Example: plgwear solve design/electrical_contact.toml
    """
    given = read_scene(scene_file)
    with computing("computing the quantities", one_question=True):
        import numpy as np

        with refusing_scene(scene_file):
            quantities = given.solve(digits=digits)
    radius = quantities.get("contact_radius")
    doubt_units(scene_file, given, None if radius is None else float(radius.value))
    for name, quantity in quantities.items():
        values = np.asarray(quantity.value)
        if np.any(np.isnan(values)) or (quantity.radii is None and np.isinf(values)):
            refuse(f"{scene_file}: {name} exceeds the range of numbers: some value in the scene is too extreme")
    if as_json:
        print_json({"scene": str(scene_file), "quantities": {name: _listed(q) for name, q in quantities.items()}})
    else:
        _print_quantities(scene_file, quantities)


def _listed(quantity: "Quantity") -> dict[str, Any]:
    known = {"value": quantity.value, "unit": quantity.unit, "description": quantity.description}
    if quantity.radii is not None:
        known |= {"radii": quantity.radii, "radii_unit": "m"}
    if quantity.edge_distance is not None:
        known |= {"edge_distance": quantity.edge_distance}
    if quantity.unbounded_at is not None:
        known |= {"edge_value": quantity.edge_value, "unbounded_at": quantity.unbounded_at}
    return known


def _print_quantities(scene_file: Path, quantities: "dict[str, Quantity]") -> None:
    import numpy as np

    table = table_of(scene_file)
    table.add_column("quantity", no_wrap=True)
    table.add_column("value", justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    along = any(quantity.radii is not None or quantity.edge_distance is not None for quantity in quantities.values())
    if along:
        table.add_column("at r", no_wrap=True)
    table.add_column("meaning")
    for name, quantity in quantities.items():
        value, place, meaning = quantity.value, "", quantity.description
        if quantity.edge_distance is not None:
            place = f"edge - {measure(quantity.edge_distance, 'm')}"
        if isinstance(value, np.ndarray) and quantity.radii is not None:
            if quantity.edge_value is not None:
                value = quantity.edge_value
                meaning += f"; unbounded at {quantity.unbounded_at}"
            else:
                extreme = int(np.argmax(np.abs(value)))
                value, place = float(value[extreme]), measure(quantity.radii[extreme], "m")
                meaning += "; largest"
        number, _, unit = measure(float(value), quantity.unit).partition(" ")
        table.add_row(name, number, unit, *([place] if along else []), meaning)
    console().print(table)
