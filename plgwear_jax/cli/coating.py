"""The command `plgwear coating`: a measured E(z) as a power law, and what the idealisation does."""

import csv
import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from plgwear_jax._core.words import one_line, read_text
from plgwear_jax._files import check_target, check_targets
from plgwear_jax._files import write as write_whole
from plgwear_jax.cli import drawing
from plgwear_jax.cli.computing import computing
from plgwear_jax.cli.question import MEANINGS, UNITS, AsJson, Picture, doubt_units, read_scene, refusing_scene
from plgwear_jax.cli.terminal import (
    console,
    measure,
    measures,
    print_json,
    refuse,
    refusing_targets,
    table_of,
    warn,
    working,
)

if TYPE_CHECKING:
    from plgwear_jax.coating import Idealisation, PowerLawFit
    from plgwear_jax.scene import Scene

__all__ = ["coating"]

_MOST = 40  # rows that are printed
_REMARK = "an indentation modulus is a mean over the depths that the tip felt, not E at one depth"


def coating(
    table: Annotated[
        Path,
        typer.Argument(
            metavar="TABLE.csv",
            help="A CSV file with the columns depth and modulus; units may stand there, as depth (um), modulus (GPa).",
            show_default=False,
        ),
    ],
    scene_file: Annotated[
        Path,
        typer.Option(
            "--scene",
            metavar="SCENE.toml",
            help="The scene of a fretting contact on this coating; of its [material] only nu counts.",
            show_default=False,
        ),
    ],
    as_json: AsJson = False,
    picture: Picture = None,
    out: Annotated[
        Path | None,
        typer.Option(help="A .toml file to write: the scene, with the power law as [material].", show_default=False),
    ] = None,
    csv_file: Annotated[
        Path | None,
        typer.Option("--csv", help="A .csv file to write: the table beside the fit, in SI units.", show_default=False),
    ] = None,
) -> None:
    """Fit a power law to a measured modulus E(z), and show what this idealisation does to contact and wear.

    The fit counts each depth as the contact of the scene feels it, between 0.1 and 3 contact radii. Below its last row
    and above its first one the table is taken as constant. An indentation modulus is a mean over the depths that the
    tip felt, and not E at one depth.

    Example: plgwear coating E_of_z.csv --scene contact.toml --out power_law.toml
    """
    from plgwear_jax import tables

    given = read_scene(scene_file)
    try:
        data = tables.read_modulus(table)
    except tables.TableError as error:
        refuse(str(error))
    nu = _refuse_other_scenes(scene_file, given)
    picture = picture or Path(f"{table.stem}-coating.png")
    with refusing_targets():
        check_targets(picture, csv_file)
        text = None if out is None else _scene_text(scene_file, given, out)
        with computing("computing the contact", one_question=True):
            import dataclasses

            import numpy as np

            from plgwear_jax import coating as mathematics
            from plgwear_jax.contact import FrettingContact
            from plgwear_jax.surfaces import DepthGraded

            with refusing_scene(scene_file):
                assert given.load is not None
                force = given.load.largest
                contact = given.build_contact()
            assert isinstance(contact, FrettingContact)
            half_space = DepthGraded(data.depth, data.modulus, nu)
            contact = dataclasses.replace(contact, material=half_space)
            as_given = mathematics.worn(contact, force)
            radius = float(as_given["contact_radius"])
            try:
                fit = mathematics.fit_power_law(data.depth, data.modulus, nu, radius)
            except ValueError as error:
                refuse(f"{data.name}: {error}")
            idealisation = mathematics.idealised(contact, force, fit.material, as_given)
            if not np.all(np.isfinite(idealisation.quantities["wear_volume"])):
                refuse(f"{scene_file}: the wear exceeds the range of numbers: some value in the scene is too extreme")
            counts = mathematics.where_it_counts(contact, force, radius)
            depths = np.geomspace(0.01 * radius, 10.0 * radius, 200)
            curve = depths, np.asarray(half_space.modulus_at(depths))
        with working("drawing it"):
            plots = drawing.plots()
            plots.save(plots.coating_picture(fit, curve, counts, idealisation, contact), picture)
        if csv_file is not None:
            _write_csv(fit, csv_file)
        if out is not None and text is not None:
            _write_scene(text, fit, data.name, out)
    doubt_units(scene_file, given, radius)
    if as_json:
        print_json(_as_json(scene_file, data.name, force, fit, idealisation, counts) | {"picture": str(picture)})
    else:
        if given.load.remark is not None:
            typer.echo(given.load.remark)
        _print_fit(data.name, fit)
        _print_comparison(scene_file, idealisation)
        typer.echo(f"indentation: {_REMARK}")
        for kind, file in (("picture", picture), ("table", csv_file), ("scene", out)):
            if file is not None:
                typer.echo(f"{kind}: {one_line(str(file))}")
    if fit.doubt is not None:
        warn(f"{data.name}: {fit.doubt}")


def _refuse_other_scenes(scene_file: Path, given: "Scene") -> float:
    """Poisson's ratio of a scene that can be asked; others are refused."""
    if given.load is None:
        refuse(f'{scene_file}: [contact] kind = "gross-slip": only a fretting contact takes an E(z) from a table')
    if given.load.is_zero:
        refuse(f"{scene_file}: [load]: an amplitude of 0: nothing wears")
    if isinstance(given.material.nu, str):
        refuse(f'{scene_file}: [material] nu = "holl": changes with k; a table needs a number')
    return given.material.nu


def _scene_text(scene_file: Path, given: "Scene", out: Path) -> tuple[str, str]:
    """What stands in a scene before and after its section [material]."""
    check_target(out, (".toml",))
    assert given.load is not None
    named = given.load.table or given.load.history
    if named is not None and out.resolve().parent != scene_file.resolve().parent:
        refuse(f"--out {one_line(str(out))}: must be in the folder of the scene, where {one_line(named)} is")
    text = read_text(scene_file, "a scene is a TOML file", ValueError)
    found = re.search(
        r"^[ \t]*\[[ \t]*material[ \t]*\][^\n]*\n(?:(?![ \t]*\[)[^\n]*\n?)*?(?=[ \t]*\[|\Z)", text, re.MULTILINE
    )
    if found is None:
        refuse(f"--out: {scene_file}: has no line [material] after which the power law could be written")
    lines = found.group().splitlines(keepends=True)
    while len(lines) > 1 and lines[-1].lstrip()[:1] in ("", "#"):  # comments there belong to the next section
        lines.pop()
    return text[: found.start()], text[found.start() + len("".join(lines)) :]


def _write_scene(text: tuple[str, str], fit: "PowerLawFit", name: str, out: Path) -> None:
    material = fit.material
    low, high = fit.exponent_interval
    lines = (
        f"[material]                          # a power law fitted to {name}",
        f"E0 = {float(material.E0):.6g}  # Pa",  # pyright: ignore[reportArgumentType]
        f"z0 = {float(material.z0):.6g}  # m, the contact radius on E(z) as measured",  # pyright: ignore[reportArgumentType]
        f"k = {float(material.k):.6g}  # {low:.3g} to {high:.3g} with 95 % confidence",  # pyright: ignore[reportArgumentType]
        f"nu = {float(material.nu):g}",  # pyright: ignore[reportArgumentType]
    )
    whole = text[0] + "\n".join(lines) + "\n\n" + text[1].lstrip("\n")
    write_whole(out, lambda path: path.write_text(whole, encoding="utf-8"))


def _print_fit(name: str, fit: "PowerLawFit") -> None:
    import numpy as np

    table = table_of(Path(name))
    for heading in ("depth", "modulus", "power law", "difference (%)", "counts (%)"):
        table.add_column(heading, justify="right", no_wrap=True)
    for z, E, fitted, weight in list(zip(fit.depth, fit.modulus, fit.fitted, fit.weight, strict=True))[:_MOST]:
        near = f"{100.0 * (fitted / E - 1.0):+.2g}" if np.isfinite(fitted) and fitted > 0.0 else ""
        table.add_row(measure(z, "m"), measure(E, "Pa"), measure(fitted, "Pa") if near else "", near, _percent(weight))
    console().print(table)
    if fit.depth.size > _MOST:
        typer.echo(f"and {fit.depth.size - _MOST} more rows")
    (k_low, k_high), (E_low, E_high) = fit.exponent_interval, fit.modulus_interval
    k, E0, z0 = (float(np.asarray(value)) for value in (fit.material.k, fit.material.E0, fit.material.z0))
    sure = k_low == k_low
    within = f" ({k_low:.3g} to {k_high:.3g} with 95 % confidence)" if sure else ""
    typer.echo(f"power law: k = {k:.4g}{within}")
    within = f" ({measure(E_low, 'Pa')} to {measure(E_high, 'Pa')})" if sure else ""
    correlation = ""
    if sure:
        variance = np.diag(fit.covariance)
        correlated = fit.covariance[0, 1] / np.sqrt(variance[0] * variance[1]) if variance.all() else 0.0
        correlation = f"; correlation of k and log E0: {correlated:.2g}"
    typer.echo(
        f"E0 = {measure(E0, 'Pa')}{within} at z0 = {measure(z0, 'm')}, the contact radius, a free choice{correlation}"
    )
    low, high = (measure(depth, "m") for depth in fit.felt)
    typer.echo(f"the contact feels {low} to {high}; the table covers {100.0 * fit.covered:.3g} % of that")


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g}" if share > 0.0 else "0"


def _print_comparison(scene_file: Path, idealisation: "Idealisation") -> None:
    table = table_of(scene_file)
    table.add_column("")
    for heading in ("E(z) as given", "power law", "difference (%)"):
        table.add_column(heading, justify="right", no_wrap=True)
    for name, (real, power_law) in idealisation.quantities.items():
        both = measures((float(real), float(power_law)), UNITS[name])
        table.add_row(MEANINGS[name], *both, f"{100.0 * idealisation.error(name):+.2g}")
    console().print(table)


def _as_json(
    scene_file: Path, name: str, force: float, fit: "PowerLawFit", idealisation: "Idealisation", counts: Any
) -> dict[str, Any]:
    material = fit.material
    return {
        "scene": str(scene_file),
        "table": name,
        "tangential_force": force,
        "k": float(material.k),  # pyright: ignore[reportArgumentType]
        "E0": float(material.E0),  # pyright: ignore[reportArgumentType]
        "z0": float(material.z0),  # pyright: ignore[reportArgumentType]
        "nu": material.nu,
        "k_interval_95_percent": fit.exponent_interval,
        "E0_interval_95_percent": fit.modulus_interval,
        "covariance_of_k_and_log_E0": fit.covariance,
        "depth": fit.depth,
        "modulus": fit.modulus,
        "fitted": fit.fitted,
        "weight": fit.weight,
        "scatter": fit.scatter,
        "felt": fit.felt,
        "covered": fit.covered,
        "as_given": {name: both[0] for name, both in idealisation.quantities.items()},
        "power_law": {name: both[1] for name, both in idealisation.quantities.items()},
        "where_it_counts": {"depth": counts[0], "dlogV_dlogE_per_decade": counts[1]},
        "units": {"depth": "m", "modulus": "Pa", "tangential_force": "N"}
        | {name: UNITS[name] for name in idealisation.quantities},
        "doubt": fit.doubt,
        "remark": _REMARK,
    }


def _write_csv(fit: "PowerLawFit", path: Path) -> None:
    def write(target: Path) -> None:
        with target.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(("depth", "modulus", "fitted", "weight"))
            columns = (column.tolist() for column in (fit.depth, fit.modulus, fit.fitted, fit.weight))
            writer.writerows(zip(*columns, strict=True))

    write_whole(path, write)
