"""The sections of a scene file and what each may contain, except the quantities; `scene` puts them together.

The description of a field is used in messages, after the value that is not allowed.
"""

import math
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Field, PrivateAttr, field_validator, model_validator

from plgwear_jax._core.ranges import NUMBER
from plgwear_jax._core.words import one_line
from plgwear_jax.scene.design_section import Allowed, Limits, Vary, VaryIndenter, VaryShape, Window
from plgwear_jax.scene.fields import (
    Described,
    OtherFileError,
    SceneError,
    Section,
    from_table,
    in_other_file,
    number,
    positive,
    wrong,
)
from plgwear_jax.scene.material_section import SHAPES, HalfSpace, Indenter, Shape

if TYPE_CHECKING:
    import numpy as np

    from plgwear_jax.scene.solving import Moved
    from plgwear_jax.tables import Table

LOADS = ("tangential_force", "displacement", "table", "history")
COEFFICIENTS = ("coefficient", "coefficient_mm3_per_N_m", "energy_coefficient_mm3_per_J")
PRESSED = ("friction", "normal_force")


class Fretting(Described):
    """The section [contact] with kind = "fretting": an indenter, by default a rigid parabola, that wears.

    Attributes:
        kind: Which contact this is.
        radius: Radius of curvature of the indenter in m.
        normal_force: Normal force in N.
        friction: Coefficient of friction.
        indenter: The body that wears: rigid, or elastic with its own modulus and Poisson's ratio.
        shape: Shape of the indenter; left out, it is the parabola r^2/(2 R).
    """

    record_name = "contact.FrettingContact"

    kind: Literal["fretting"]
    radius: float = positive("the radius of curvature of the indenter in m")
    normal_force: float = positive("the normal force in N")
    friction: float = positive("the coefficient of friction")
    indenter: Literal["rigid"] | Indenter = Field(
        "rigid", description='must be "rigid" or { E = 210e9, nu = 0.3 }, with E > 0 in Pa and -1 < nu <= 0.5'
    )

    shape: Shape | None = Field(None, description=f"must be {SHAPES}, or left out")

    @model_validator(mode="after")
    def _finite_limit(self) -> Self:
        if math.isinf(self.friction * self.normal_force):
            raise wrong("friction", "times normal_force exceeds the range of numbers")
        return self

    @property
    def known(self) -> dict[str, Any]:
        """The fields of the record; a rigid indenter is none."""
        return {name: None if value == "rigid" else value for name, value in super().known.items()}


class GrossSlip(Described):
    """The section [contact] with kind = "gross-slip": a flat-ended punch at a constant depth.

    Attributes:
        kind: Which contact this is.
        radius: Radius of the punch in m.
        depth: Indentation depth in m, which is kept.
    """

    record_name = "contact.GrossSlipContact"

    kind: Literal["gross-slip"]
    radius: float = positive("the radius of the punch in m")
    depth: float = positive("the indentation depth in m")


class Load(Section):
    """The section [load] of a fretting contact: one amplitude, or a file of many, which the scene reads.

    Attributes:
        tangential_force: Amplitude of the force in N.
        displacement: Amplitude of the displacement in m: that of the contact, or at the actuator of a rig whose
            stiffness is given. It stays constant over the cycles; the steady state is that of the force that it needs
            before any wear.
        table: CSV file of amplitudes with weights, for an uncertain load or many contacts.
        history: CSV file of amplitudes in their order, with a column cycles for wear over cycles.
        rig_stiffness: Stiffness in N/m of the rig, if displacements are measured at its actuator.
    """

    tangential_force: float | None = number(NUMBER, "the amplitude of the force in N", None)
    displacement: float | None = number(NUMBER, "the amplitude of the displacement in m", None)
    table: str | None = Field(
        None,
        min_length=1,
        description="must be the name of a CSV file with the columns tangential_force (or displacement) and weight",
    )
    history: str | None = Field(
        None,
        min_length=1,
        description="must be the name of a CSV file with the column tangential_force (or displacement), and if wanted "
        "cycles, normal_force and friction",
    )
    rig_stiffness: float | None = positive(
        "the rig stiffness in N/m, if displacements are measured at the actuator", None
    )
    _read: "Table | None" = PrivateAttr(None)
    _contact: "tuple[HalfSpace, Fretting, Wear | None] | None" = PrivateAttr(None)

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        kinds = [name for name in LOADS if getattr(self, name) is not None]
        if not kinds:
            raise wrong("", f"needs one of its keys {', '.join(LOADS)}")
        if len(kinds) > 1:
            raise wrong(kinds[-1], f"cannot be combined with {kinds[0]}; only one of them can be the load")
        return self

    def read(self, folder: Path, contact: Fretting) -> None:
        """Read the file that is named, if any, and refuse force amplitudes from mu F_N on, where the slip is gross.

        Args:
            folder: Where names of files begin.
            contact: What has mu and F_N, unless a history has its own.
        """
        limit: Any = contact.friction * contact.normal_force
        if self.tangential_force is not None and not self.tangential_force < limit:
            text = f"this is gross slip, F_x = {self.tangential_force:g} N is not below mu F_N = {limit:g} N"
            raise wrong("tangential_force", f"{text}; lower it, or raise friction or normal_force")
        named = self.table or self.history
        if named is None:
            return
        self._read = read = from_table(lambda tables: tables.LOADS if self.table else tables.HISTORY, named, folder)
        if not self.of_displacement:
            force = read["tangential_force"]
            own: dict[str, Any] = {name: getattr(contact, name) + 0.0 * force for name in PRESSED} | self.pressed
            limit, text = own["friction"] * own["normal_force"], "this is gross slip, it must be below mu F_N ="
            try:
                read.refuse(~(force < limit), lambda i: f"tangential_force = {float(force[i])}: {text} {limit[i]:g} N")
            except ValueError as error:
                raise in_other_file(error) from None

    def belongs_to(self, material: HalfSpace, contact: Fretting, wear: "Wear | None") -> None:
        """Say which contact a displacement moves; the force is computed when it is asked for."""
        self._contact = material, contact, wear

    @cached_property
    def rows(self) -> "Table":
        """The content of the file, or the one amplitude as a table of one row."""
        if self._read is not None:
            return self._read
        import numpy as np

        from plgwear_jax.tables import Table

        name = "tangential_force" if self.displacement is None else "displacement"
        return Table("[load]", {name: np.array([getattr(self, name)], float)}, np.zeros(1, int))

    @property
    def of_displacement(self) -> bool:
        """The amplitudes are those of the displacement."""
        return self.displacement is not None or (self._read is not None and self._read.amplitude == "displacement")

    @property
    def given(self) -> "np.ndarray":
        """The amplitudes as they were given, in N or m, shape (n,): the one, or all of a history or a table."""
        return self.rows[self.rows.amplitude]

    @property
    def cycles(self) -> "np.ndarray | None":
        """How many cycles each amplitude of a history lasts, shape (n,); None if nothing says so."""
        return None if self._read is None else self._read.columns.get("cycles")

    @property
    def pressed(self) -> "dict[str, np.ndarray]":
        """The normal forces in N and the coefficients of friction that a history has of its own, each of shape (n,)."""
        own = {} if self._read is None else self._read.columns
        return {name: own[name] for name in reversed(PRESSED) if name in own}

    @property
    def is_zero(self) -> bool:
        """Nothing moves, and so nothing wears."""
        if self._read is None:
            return not (self.tangential_force or self.displacement)
        return not (self.given * self._read.columns.get("weight", 1.0)).any()

    @property
    def loads(self) -> list[Any]:
        """The amplitudes as loads of the library, each a `Force` or a `Displacement`."""
        from plgwear_jax import loads

        kind = loads.Displacement if self.of_displacement else loads.Force
        return [kind(amplitude, self.rig_stiffness) for amplitude in self.given.tolist()]

    def record(self) -> Any:
        """The load of a test over cycles: an amplitude, or the blocks of a history."""
        from plgwear_jax.loads import Block

        if self.cycles is None:
            return self.loads[0]
        names, columns = [*self.pressed], [self.cycles, *self.pressed.values()]
        rows = zip(self.loads, *(column.tolist() for column in columns), strict=True)
        return [Block(load, cycles, **dict(zip(names, own, strict=True))) for load, cycles, *own in rows]

    @cached_property
    def moved(self) -> "Moved":
        """What the displacements of `given` do to the unworn contact."""
        assert self._contact is not None
        from plgwear_jax.scene import solving

        material, contact, _ = self._contact
        pressed = solving.homogeneous(contact.record(material=material.record(), **self.pressed))
        return solving.moved(pressed, self.given, self.rig_stiffness)

    @property
    def in_gross_slip(self) -> "np.ndarray":
        """Which amplitudes of `given` make the unworn contact slip as a whole, shape (n,)."""
        import numpy as np

        return ~(self.given < np.asarray(self.moved.gross_slip if self.of_displacement else math.inf))

    @cached_property
    def forces(self) -> "np.ndarray":
        """The force amplitudes in N of `given`, shape (n,), or a SceneError where the contact slips as a whole."""
        if self.pressed:
            text = f"changes {' and '.join(self.pressed)}, so that no amplitude decides the steady state"
            raise SceneError(f"[load] history: {text}; only plgwear wear takes it")
        if not self.of_displacement:
            return self.given
        assert self._contact is not None
        import numpy as np

        _, contact, wear = self._contact
        (beyond,) = np.nonzero(self.in_gross_slip)
        if not beyond.size:
            return np.asarray(self.moved.force)
        first, rows = beyond[0], self.rows
        begins = f"from {float(self.moved.gross_slip):.4g} m on the"
        begins = f"{begins} {'contact' if self.rig_stiffness is None else 'rig'} slips as a whole"
        work = contact.normal_force * float(np.asarray(self.moved.path)[first])
        worn = f"{work:.4g} N m times the wear coefficient"
        if wear is not None and wear.exponent is None:
            worn = f"{wear.archard(contact.friction) * work:.4g} m^3"
        sliding = (
            f"by Archard's law such sliding wears {worn} a cycle at first; plgwear wear follows it over the cycles"
        )
        said = f"displacement = {self.given[first]:g}: this is gross slip, {begins}; {sliding}"
        if self._read is None:
            raise SceneError(f"[load] {said}")
        raise OtherFileError(f"{rows.name}: row {rows.row[first]}: {said}")

    @property
    def amplitudes(self) -> "np.ndarray":
        """Amplitudes in N, shape (n,): the one amplitude, all of a history, or those of a table with weight > 0."""
        weight = self.rows.columns.get("weight")
        return self.forces if weight is None else self.forces[weight > 0.0]

    @property
    def weights(self) -> "np.ndarray | None":
        """Weights of the amplitudes of a table, > 0, shape (n,), with the sum 1; None if there is no table."""
        if self.table is None:
            return None
        from plgwear_jax.optimise.scenarios import shares

        weight = self.rows["weight"]
        return shares(weight[weight > 0.0])

    @property
    def largest(self) -> float:
        """The largest amplitude in N: it determines the worn state of a history, and the worst case of a table."""
        return float(self.amplitudes.max() if self.tangential_force is None else self.tangential_force)

    @property
    def force(self) -> "float | np.ndarray":
        """What enters a computation, in N: one amplitude, the largest of a history, or the amplitudes of a table."""
        return self.largest if self.table is None else self.amplitudes

    @property
    def remark(self) -> str | None:
        """The line that says which amplitude of a history counts, and which force goes with a displacement, or None."""
        if self.pressed:
            return None
        if self.displacement is not None:
            whose = "" if self.rig_stiffness is None else " of the rig"
            told = (
                f"a force amplitude of {self.largest:.4g} N before wear"
                if not self.in_gross_slip.any()
                else (f"the contact slips as a whole, from {float(self.moved.gross_slip):.4g} m on")
            )
            return f"displacement {self.displacement:g} m{whose}: {told}"
        if self.history is None:
            return None
        number = "1 amplitude" if self.forces.size == 1 else f"{self.forces.size} amplitudes"
        deciding = (
            f"the largest, {self.largest:g} N (row {self.rows.row[self.forces.argmax()]}), decides the worn state"
        )
        return f"history {one_line(self.history)}: {number}; {deciding}"


class Wear(Section):
    """The section [wear]: how fast the contact wears, by default by Archard's law, and for how long.

    Attributes:
        coefficient: Worn volume over normal force and sliding distance, in 1/Pa = m^3/(N m); with an exponent in
            1/Pa^exponent.
        coefficient_mm3_per_N_m: The same in mm^3/(N m).
        energy_coefficient_mm3_per_J: Worn volume over the energy of friction, in mm^3/J.
        exponent: Exponent of the pressure in the wear law; left out, it is 1, Archard's law.
        half_space_coefficient: Coefficient of the half-space in 1/Pa, or 1/Pa^exponent, if it wears too; `coefficient`
            is then that of the indenter.
        cycles: Number of cycles of the life.
    """

    coefficient: float | None = positive("the wear coefficient in 1/Pa = m^3/(N m)", None)
    coefficient_mm3_per_N_m: float | None = positive("the wear coefficient in mm^3/(N m)", None)  # noqa: N815
    energy_coefficient_mm3_per_J: float | None = positive("the wear per energy of friction in mm^3/J", None)  # noqa: N815
    exponent: float | None = positive("the exponent of the pressure in the wear law", None)
    half_space_coefficient: float | None = positive("the wear coefficient of the half-space in 1/Pa", None)
    cycles: float | None = positive("the life in cycles", None)

    @model_validator(mode="after")
    def _one_coefficient(self) -> Self:
        there = [name for name in COEFFICIENTS if getattr(self, name) is not None]
        if not there:
            raise wrong("", f"needs one of its keys {', '.join(COEFFICIENTS)}")
        if len(there) > 1:
            raise wrong(there[-1], f"cannot be combined with {there[0]}; only one of them can be the wear coefficient")
        for name in self.others:
            if self.coefficient is None:
                raise wrong(name, f"cannot be combined with {there[0]}; give coefficient, in 1/Pa or 1/Pa^exponent")
        return self

    @property
    def others(self) -> list[str]:
        """The keys that only some commands take."""
        return [name for name in ("exponent", "half_space_coefficient") if getattr(self, name) is not None]

    def archard(self, friction: float) -> float:
        """Archard's wear coefficient in 1/Pa; from an energy coefficient it is that times the coefficient of friction.

        Args:
            friction: The coefficient of friction.

        Raises:
            SceneError: The section has another wear law, or wear of the half-space.
        """
        for name in self.others:
            raise SceneError(f"[wear] {name} = {getattr(self, name):g}: only plgwear wear takes it")
        return self._indenter(friction)

    def _indenter(self, friction: float) -> float:
        if self.coefficient is not None:
            return self.coefficient
        if self.coefficient_mm3_per_N_m is not None:
            return self.coefficient_mm3_per_N_m / 1e9
        return friction * (self.energy_coefficient_mm3_per_J or 0.0) / 1e9

    @property
    def half_space_share(self) -> float:
        """The share of the half-space in all wear."""
        own = self.half_space_coefficient
        return 0.0 if own is None or self.coefficient is None else own / (self.coefficient + own)

    def record(self, friction: float) -> Any:
        """The wear law; its coefficient is the sum over both bodies."""
        from plgwear_jax.wear_laws import law_of

        return law_of(self._indenter(friction) + (self.half_space_coefficient or 0.0), self.exponent)


class Output(Section):
    """The section [output]: the quantities asked for.

    Attributes:
        quantities: Names of quantities; without this section plgwear solve gives all single numbers.
        distance: Distance inside the edge, in m, at which pressures and tractions are given that are infinite at the
            edge.
        points: Number of radii at which a function of the radius is given.
    """

    quantities: Annotated[tuple[str, ...], Field(strict=False, min_length=1)] = Field(
        description="must be a list of one or more names of quantities"
    )
    distance: float | None = positive("the distance inside the edge at which pressures are given, in m", None)
    points: int = Field(201, ge=2, le=100_000, description="must be a whole number from 2 to 100000")

    @field_validator("quantities")
    @classmethod
    def _each_once(cls, quantities: tuple[str, ...]) -> tuple[str, ...]:
        for name in quantities:
            if quantities.count(name) > 1:
                raise wrong("quantities", f'"{name}" is asked for more than once')
        return quantities


INNER: dict[str, Any] = {
    "vary": Vary,
    "modulus": Window,
    "limits": Limits,
    "indenter": VaryIndenter,
    "shape": VaryShape,
    **{name: Allowed for name in Limits.model_fields if name != "modulus"},
}
