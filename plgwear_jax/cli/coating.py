"""The command `plgwear coating`: a measured E(z) as a power law, and what the idealisation does."""

import dataclasses
import re
from pathlib import Path
from typing import Annotated

import typer

from plgwear_jax._core import files
from plgwear_jax._core.catalogue import measured
from plgwear_jax._core.words import one_line, read_text

from .report import Column, Report, each_with_unit, fields
from .terminal import AsJson, CsvFile, Picture, computing, option, read_scene, refuse, refuse_extremes, warn

# A section ends with its last key: comments further down belong to the next one.
_MATERIAL = re.compile(
    r"^[ \t]*\[[ \t]*material[ \t]*\][^\n]*\n(?:(?:[^\S\n]*(?:#[^\n]*)?\n)*[^\S\n]*[^\s#\[][^\n]*\n?)*\n*", re.MULTILINE
)
_SECTION = """\
[material]                          # a power law fitted to {table}
E0 = {E0:.6g}  # Pa, the modulus at the depth z0
z0 = {z0:.6g}  # m, the contact radius on E(z) as measured
k = {k:.6g}{within}
nu = {nu:.6g}  # Poisson's ratio

"""
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
        option(
            "--scene",
            metavar="SCENE.toml",
            help="The input file of a fretting contact on this coating; of its [material] only nu counts.",
        ),
    ],
    as_json: AsJson = False,
    picture: Picture = None,
    out: Annotated[
        Path | None, option(help="A .toml file to write: the input file, with the power law as [material].")
    ] = None,
    csv_file: CsvFile = None,
) -> None:
    """Fit a power law to a measured modulus E(z), and show what this idealisation does to contact and wear.

    Between 0.1 and 3 contact radii each depth has the weight in the fit that it has in the stiffness of the contact.
    Below the last row of the table and above the first one E is constant. An indentation modulus is a mean over the
    depths that the tip felt, and not E at one depth.

    Example: plgwear coating E_of_z.csv --scene contact.toml --out power_law.toml
    """
    from plgwear_jax import tables

    given = read_scene(scene_file)
    data = tables.read(table, tables.MODULUS)
    if given.load is None:
        refuse(f'{scene_file}: [contact] kind = "gross-slip": only a fretting contact takes an E(z) from a table')
    given.load.refuse_rest()
    if isinstance(given.material.nu, str):
        refuse(f'{scene_file}: [material] nu = "holl": changes with k; a table needs a number')
    report = Report(scene_file, as_json, f"{table.stem}-coating", table, picture=picture, table=csv_file, scene=out)
    text = ""
    if out:
        named = given.load.table or given.load.history
        if named and out.resolve().parent != scene_file.resolve().parent:
            refuse(f"--out {one_line(str(out))}: must be in the folder of the input file, where {one_line(named)} is")
        text = read_text(scene_file, "an input file is a TOML file", ValueError)
        if _MATERIAL.search(text) is None:
            refuse(f"--out: {scene_file}: has no line [material] after which the power law could be written")
    with computing("computing the contact"):
        import numpy as np

        from plgwear_jax import coating as mathematics
        from plgwear_jax._core.domains import RefusedError
        from plgwear_jax.scene.sections import Body, LoadSection

        body = Body("surfaces.DepthGraded", "a table", {**data.columns, "nu": given.material.nu}, data)
        # A displacement needs another force on the table than on the [material] of the input file.
        load = LoadSection(**vars(given.load) | {"material": body})
        given = dataclasses.replace(given, load=load)
        force, contact = load.largest, given.contact.record(material=body.record())
        try:
            fit, _, counts, idealisation = study = mathematics.studied(contact, force)
        except RefusedError:  # the contact, not its table
            raise
        except ValueError as error:
            refuse(f"{data.name}: {error}")
        refuse_extremes(np.all(np.isfinite(idealisation.quantities["wear_volume"])))
    report.draw("coating_picture", *study)
    columns = fields(fit, "depth", "modulus", "fitted", "weight")
    report.write_table(columns)
    law = vars(fit.material)
    k_within, E_within = (  # NaN, of which the data tell none, is not itself
        f" ({measured(name, within)} with 95 % confidence)" if within[0] == within[0] else ""
        for name, within in (("k", fit.exponent_interval), ("E0", fit.modulus_interval))
    )
    if out:
        section = _SECTION.format(table=data.name, within=k_within and f"  #{k_within}", **law)
        whole = _MATERIAL.sub(lambda _: section, text, count=1)
        files.write(out, lambda path: path.write_text(whole, encoding="utf-8"))
    report.doubt(given, idealisation.quantities["contact_radius"][0])
    report.put(
        table=data.name,
        tangential_force=force,
        **law,
        k_interval_95_percent=fit.exponent_interval,
        E0_interval_95_percent=fit.modulus_interval,
        covariance_of_k_and_log_E0=fit.covariance,
        **columns,
        **fields(fit, "scatter", "felt", "covered", "doubt"),
        where_it_counts={"depth": counts[0], "dlogV_dlogE_per_decade": counts[1]},
        remark=_REMARK,
    )
    report.say(load.remark)
    fitted = np.where((fit.fitted > 0.0) & np.isfinite(fit.fitted), fit.fitted, np.nan)
    near = np.round(100.0 * (fitted / fit.modulus - 1.0), 6) + 0.0  # less is rounding, and no sign
    report.table(
        each_with_unit("depth", fit.depth),
        each_with_unit("modulus", fit.modulus, "modulus"),
        each_with_unit("modulus", fitted, "power law"),
        Column("difference (%)", [f"{x:+.2g}" if x == x else "" for x in near]),
        Column("counts (%)", [f"{100.0 * share:.2g}" for share in fit.weight]),
        title=data.name,
        more="rows",
    )
    (variance, covariance), (_, other) = fit.covariance
    correlated = covariance / np.sqrt(variance * other) if variance else 0.0
    correlation = f"; correlation of k and log E0: {correlated:.2g}" if k_within else ""
    E0, z0 = (f"{name} = {measured(name, law[name])}" for name in ("E0", "z0"))
    felt = measured("depth", fit.felt)
    report.say(
        f"power law: k = {law['k']:.4g}{k_within}",
        f"{E0}{E_within} at {z0}, the contact radius, a free choice{correlation}",
        f"the depths from {felt} count for the contact; the table covers {100.0 * fit.covered:.3g} % of that",
    )
    errors = [f"{100.0 * idealisation.error(name):+.2g}" for name in idealisation.quantities]
    sides = {"as_given": "E(z) as given", "power_law": "power law"}
    report.compare(sides, idealisation.quantities, Column("difference (%)", errors))
    report.say(f"indentation: {_REMARK}")
    report.end()
    if fit.doubt:
        warn(f"{data.name}: {fit.doubt}")
