"""Maps of quantities, their derivatives and optimal designs over any axes, of any size: labelled and resumable.

Needs the extra `sweep`: xarray, zarr, Dask. A sweep in memory is an `xarray.Dataset`. A sweep into a Zarr store is
computed and written chunk by chunk; after a stop, finished chunks are not computed again.
"""

import contextlib
import itertools
from collections.abc import Callable, Generator, Mapping, Sequence
from typing import Any

import jax.numpy as jnp
import numpy as np
import xarray as xr

from plgwear_jax._core.catalogue import AMPLITUDES, leaf
from plgwear_jax._core.domains import EXPONENT, ArrayLike, check_bounds, check_digits, concrete_only, whole
from plgwear_jax._core.doubts import doubt, of_contact
from plgwear_jax._core.leaves import leaf_of, with_leaf
from plgwear_jax._core.words import PathGiven, near_or_all
from plgwear_jax.contact import FrettingContact, GrossSlipContact
from plgwear_jax.loads import Displacement, Force, load_of
from plgwear_jax.optimise import tail_weights
from plgwear_jax.optimise.question import LoadGiven

from .axes import AxisError, check_axis
from .names import SLIPS, AxisNames, QuantityError, axis_unit
from .plan import LOAD, SweepPlan
from .store import SweepError, SweepStore, labelled, open_sweep

Progress = Callable[[int, int], None]


@concrete_only("the quantities of contact.steady(load) and the functions of fretting work there")
def sweep(
    quantities: str | Sequence[str],
    *,
    contact: FrettingContact | GrossSlipContact | None = None,
    load: LoadGiven = None,
    loads: Mapping[str, tuple[ArrayLike, ArrayLike]] | None = None,
    design: Mapping[str, Any] | None = None,
    bounds: tuple[float, float] = (-0.95, 0.95),
    digits: int | None = None,
    out: PathGiven | None = None,
    chunk: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
    **axes: ArrayLike | str,
) -> xr.Dataset:
    """Compute quantities at every combination of the values along some axes.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        quantities: Names of functions of `fretting`, `gross_slip` and `material`, in the paper's units, such as
            "wear_volume" or "gross_slip.force_ratio"; with a contact any quantity of `catalogue`, in SI units, such as
            "slip_amplitude" or "transient.wear_volume". Derivatives are written after the name, "wear_volume.dk",
            "wear_volume.dk.dphi". "optimal_exponent.k" and so on are the fields of `optimise.optimal_exponent`. With a
            contact, those of `optimise.designs` are "design.k" (or another variable), "design.wear_volume" (or another
            objective), "design.saving", "design.certified" etc.
        contact: The contact whose methods are meant; an axis replaces the field of its name.
        load: What is held over cycles, as `FrettingContact.over_cycles` and `optimise.designs` take it: a
            `Displacement`, of partial or gross slip, a list of `Block`, or an amplitude of the force. Its numbers are
            axes where they are arrays, shape (n,), or are given as such: "displacement" and "rig_stiffness",
            "load[0].cycles" of the first block and so on, and "factor" on all amplitudes of blocks. A displacement is
            kept over the cycles; in the steady state it is the force that it needs before any wear.
        loads: Uncertain loads by name, each a pair of amplitudes in N and weights, shape (n,). Several of them form an
            axis, `load_case`. Quantities that depend on the amplitude are then weighted means.
        design: For "design. ...": the keyword arguments of `optimise.designs`, such as `vary`. Axes replace those of
            their names, such as "cycles".
        bounds: For "optimal_exponent. ...": the lowest and highest exponent.
        digits: Correct digits wanted; by default all that the dtype holds.
        out: A folder that ends in .zarr, for results that are to be kept, or are larger than the memory. If it holds a
            part of the same sweep, only the rest is computed. By default the result is in memory.
        chunk: How many points are computed at a time, and stored in a file; by default some megabytes.
        scheduler: The address of a Dask scheduler whose workers compute the chunks, such as "tcp://host:8786". All of
            them must see the folder `out`.
        progress: Called with the number of points done and of all points, after each chunk.
        **axes: The values along each axis, shape (n,), or a single value: k, phi, nu (or "holl"), r and distance (in
            a_0); with a contact any number of it in SI units by its path, such as "radius", "material.k" or just "k",
            "indenter.E", "material.modulus[2]"; tangential_force in N, phi, or displacement in m, of a rig with its
            rig_stiffness in N/m; factor of `loads`; r and distance in m; cycles and wear_coefficient in 1/Pa, or share.
            The first axis varies slowest.

    Returns:
        The quantities by name, with "_" for ".", each along the axes that it depends on, with units, meaning, equation
        and digits as attributes; float32 where `jax_enable_x64` is off or all axes are float32. With `out`, values are
        read from the store when they are used. Under a displacement "gross_slip" says where the whole contact slips
        before any wear; quantities of the steady state are NaN there.

    Raises:
        ValueError: A quantity does not exist or lacks an axis, an axis is not used or has a value outside its range, or
            `out` cannot be written to or holds something else; one line.

    Examples:
        >>> import numpy as np
        >>> from plgwear_jax import sweep
        >>> ds = sweep.sweep(["wear_volume"], k=np.linspace(-0.9, 0.9, 5), phi=[0.1, 0.5])
        >>> print(dict(ds.sizes), ds.wear_volume.attrs["units"])
        {'k': 5, 'phi': 2} a_0^4/R
    """
    given: Any = quantities if np.iterable(quantities) and not isinstance(quantities, str) else [quantities]
    names: tuple[str, ...] = tuple(given)
    if not names:
        raise QuantityError("quantities: name at least one")
    for name in names:
        if not isinstance(name, str):
            raise QuantityError(f"quantities takes names, not {name!r}")
        if names.count(name) > 1:
            raise QuantityError(f"{name}: is asked for more than once")
    if not isinstance(contact, FrettingContact | GrossSlipContact | None):
        raise SweepError(f"contact takes a FrettingContact or a GrossSlipContact, not {contact!r}")
    for name, one in (("loads", loads), ("design", design)):
        if not isinstance(one, Mapping | None):
            raise SweepError(f"{name} takes a mapping by names, not {one!r}")
    for name, one, has in (("load", load, "one"), ("loads", loads, "them")):
        if one is not None and not isinstance(contact, FrettingContact):
            raise SweepError(f"{name}: only a FrettingContact has {has}")
    if contact is not None:
        doubt(*of_contact(contact))
    if loads is not None and not loads:
        raise SweepError("loads: name at least one")
    loads = loads or {}
    kind = Displacement if "displacement" in axes else Force
    known = AxisNames(contact, kind(0.0) if load is None else load_of(load))
    if load is not None:
        axes = {
            name: value
            for name, path in known.of_load.items()
            if name not in axes and (value := leaf_of(known.load, path)) is not None
        } | axes
    rows, fixed = _sorted_out(axes, known, contact)
    inputs = _inputs(loads, known.held, [*rows, *fixed]) if isinstance(contact, FrettingContact) else ()
    if "displacement" in inputs and SLIPS not in names:
        names = *names, SLIPS
    amplitudes = _side_by_side(loads) if loads else None
    dtype = jnp.result_type(np.float32 if rows else float, *rows.values())
    # Checked once more: rounded to float32 a value may have left its range.
    rows = {name: check_axis(name, np.array(row, dtype)) for name, row in rows.items()}
    if len(loads) > 1:
        rows[LOAD] = np.arange(len(loads), dtype=np.int32)
    digits = check_digits(digits, dtype)
    check_bounds(bounds, EXPONENT, dtype)
    if not rows:
        raise AxisError("nothing to sweep: give at least one axis several values, shape (n,)")
    if chunk is not None:
        whole("chunk", chunk, 1)
    plan = SweepPlan(
        contact=contact,
        known=known,
        inputs=inputs,
        amplitudes=amplitudes,
        design=design,
        bounds=bounds,
        digits=digits,
        names=names,
        axes=rows,
        fixed=fixed,
        loads=tuple(loads),
        dtype=dtype,
        most=chunk,
    )
    _refuse(plan)
    try:
        used = {axis for variable in plan.variables.values() for axis in variable.dims}
    except (ValueError, TypeError) as error:  # of the library itself
        raise SweepError(str(error)) from None
    numbers = rows
    if contact is None:  # single values count too, which are no axes of a quantity
        used.update(*(asked.needs for asked in plan.asked))
        numbers = rows | fixed
    for name in numbers:
        if name not in used:
            raise AxisError(f"{name}: none of {', '.join(names)} depends on it")
    if out is None:
        if scheduler is not None:
            raise SweepError("scheduler: a sweep on a cluster needs out, a Zarr store that all its workers see")
        return _in_memory(plan, progress)
    store = SweepStore(out, plan)
    with store.held() as missing:
        steps = (store.write(*found) for found in plan.computed(missing))
        if scheduler is not None:
            from . import cluster

            steps = cluster.run_on_cluster(plan, store, missing, scheduler)
        _followed(plan, steps, missing, progress)
        store.finish()
    return open_sweep(out)


# --- running --------------------------------------------------------------------------------------------------------


def _followed(plan: SweepPlan, steps: Generator[int], missing: Sequence[int], progress: Progress | None) -> None:
    """Compute the chunks that are missing, and tell the progress from the number of points of each step."""
    with contextlib.closing(steps):
        for now in itertools.accumulate(steps, initial=plan.points - plan.size(missing)):
            if progress is not None:
                progress(now, plan.points)


def _in_memory(plan: SweepPlan, progress: Progress | None) -> xr.Dataset:
    try:
        empty = {name: one.copy(data=np.empty(one.shape, one.dtype)) for name, one in plan.variables.items()}
    except (MemoryError, ValueError):
        size = sum(variable.nbytes for variable in plan.variables.values())
        raise SweepError(f"{plan.points} points take {size / 1e9:.3g} GB of memory; name a Zarr store, out") from None
    found = labelled(plan).assign(empty)
    every = range(len(plan.places))
    _followed(plan, (plan.keep(found, *chunk) for chunk in plan.computed(every)), every, progress)
    return found


# --- what is refused ------------------------------------------------------------------------------------------------


def _inputs(loads: Any, held: Any, given: list[str]) -> tuple[str, ...]:
    """The inputs of the load of a fretting contact, among the names that are given."""
    several = [name for name, there in (("loads", loads), ("load", held)) if there]
    setting = [*(name for name in AMPLITUDES if name in given), *several]
    if len(setting) > 1:
        raise AxisError(f"{' and '.join(setting)}: only one can set the amplitude")
    if "factor" in given and not several:
        raise AxisError("factor: is that of several amplitudes, loads or blocks")
    first = [] if "load" in several else [LOAD] if several else setting or ["tangential_force"]
    return *first, *(name for name in given if name in ("rig_stiffness", "factor") or name.startswith("load["))


def _sorted_out(
    axes: Mapping[str, Any], known: AxisNames, contact: FrettingContact | GrossSlipContact | None
) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """The axes, and the inputs with a single value, including the fields of the contact."""
    names = {}
    for name in axes:
        before = names.setdefault(known.paths.get(name, name), name)
        if before != name:
            raise AxisError(f"{name}: is the same as {before}")
    rows, fixed = {}, {}
    for name, value in known.own.items():
        if np.ndim(value) > 1 or (np.ndim(value) and not leaf(f"{name}[0]").listed):
            raise AxisError(f"{name}: the contact holds {np.size(value)} values; give them as an axis of the sweep")
        if not np.ndim(value) and known.paths[name] not in names:
            fixed[name] = value
    numbers = ((contact, known.paths), (known.load, known.of_load))
    for name, values in axes.items():
        if name not in {*known.paths, *known.allowed} and not (known.held and name in known.of_load):
            about = "a sweep without a contact" if contact is None else f"a {type(contact).__name__}"
            raise AxisError(f"{name}: is no axis of {about}{near_or_all(name, known.allowed)}")
        if isinstance(values, str):
            of_ratio = known.paths.get(name, name) in ("nu", "material.nu")
            if values != "holl" or not of_ratio:
                raise AxisError(f"{name} = {values!r}: takes numbers{' or holl' if of_ratio else ''}")
            fixed[name] = values
            continue
        array = check_axis(name, values)
        try:
            for record, paths in numbers:
                if name in paths:
                    with_leaf(record, paths[name], array)
        except ValueError as error:
            raise AxisError(f"{name}: {error}") from None
        if array.ndim:
            rows[name] = array
        else:
            fixed[name] = float(array)
    return rows, fixed


def _side_by_side(loads: Mapping[str, tuple[ArrayLike, ArrayLike]]) -> tuple[np.ndarray, np.ndarray]:
    """Amplitudes and normalised weights of all loads, in one array each; padding has no weight."""
    pairs = []
    for name, (force, weight) in loads.items():
        try:
            force = check_axis("tangential_force", force)
            pairs.append((force, tail_weights(force, weight)))
        except (ValueError, TypeError) as error:
            raise SweepError(f"load {name}: {error}") from None
    longest = max(force.size for force, _ in pairs)
    forces = [np.pad(force, (0, longest - force.size), mode="edge") for force, _ in pairs]
    return np.stack(forces), np.stack([np.pad(shares, (0, longest - shares.size)) for _, shares in pairs])


def _refuse(plan: SweepPlan) -> None:
    """Refuse amplitudes that reach the friction force in any combination of the axes, and what lacks an input."""
    if {LOAD, "tangential_force"} & {*plan.inputs}:
        known: dict[str, Any] = {"factor": 1.0, "tangential_force": 0.0, **plan.fixed, **plan.axes}
        forces, _ = plan.amplitudes or (known["tangential_force"], None)
        largest = np.max(known["factor"]) * np.max(forces)
        limit = np.min(known["friction"]) * np.min(known["normal_force"])
        if not largest < limit:
            told = f"this is gross slip; it must be below the least mu F_N, {limit:g} N"
            raise AxisError(f"tangential_force = {largest}: {told}")
    for asked in plan.asked:
        for need in asked.needs:
            if need not in (*plan.axes, *plan.fixed, LOAD):
                by_phi = need == "tangential_force" and "phi" in plan.known.allowed
                unit = axis_unit(need, plan.contact)
                in_units = f" in {unit}" if unit != "1" else ""
                raise QuantityError(
                    f"{asked.name}: needs {need}{in_units}{', phi, displacement or loads' if by_phi else ''}"
                )
