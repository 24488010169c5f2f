"""The sections of a scene file and what each may contain, except the quantities; `scene` puts them together.

The description of a field is used in messages, after the value that is not allowed.
"""

import math
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Field, PrivateAttr, field_validator, model_validator
from pydantic_core import PydanticCustomError

from plgwear_jax._core.words import one_line

if TYPE_CHECKING:
    import numpy as np

    from plgwear_jax.scene.solving import Moved
    from plgwear_jax.tables import Amplitudes
from plgwear_jax.scene.design_section import Allowed, Limits, Vary, VaryIndenter, VaryShape, Window
from plgwear_jax.scene.fields import OtherFileError, SceneError, Section, positive, wrong
from plgwear_jax.scene.material_section import SHAPES, Indenter, Layers, Material, Shape, Tabulated

LOADS = ("tangential_force", "displacement", "table", "history")
COEFFICIENTS = ("coefficient", "coefficient_mm3_per_N_m", "energy_coefficient_mm3_per_J")


class Fretting(Section):
    """The section [contact] with kind = "fretting": an indenter, by default a rigid parabola, that wears.

    Attributes:
        kind: Which contact this is.
        radius: Radius of curvature of the indenter in m.
        normal_force: Normal force in N.
        friction: Coefficient of friction.
        indenter: The body that wears: rigid, or elastic with its own modulus and Poisson's ratio.
        shape: Shape of the indenter; left out, it is the parabola r^2/(2 R).
    """

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


class GrossSlip(Section):
    """The section [contact] with kind = "gross-slip": a flat-ended punch at a constant depth.

    Attributes:
        kind: Which contact this is.
        radius: Radius of the punch in m.
        depth: Indentation depth in m, which is kept.
    """

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

    tangential_force: float | None = Field(
        None, ge=0.0, allow_inf_nan=False, description="must be a finite number >= 0, the amplitude of the force in N"
    )
    displacement: float | None = Field(
        None,
        ge=0.0,
        allow_inf_nan=False,
        description="must be a finite number >= 0, the amplitude of the displacement in m",
    )
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
    _read: "Amplitudes | None" = PrivateAttr(None)
    _contact: "tuple[Material | Tabulated | Layers, Fretting, Wear | None] | None" = PrivateAttr(None)

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        kinds = [name for name in LOADS if getattr(self, name) is not None]
        if not kinds:
            raise wrong("", f"needs one of its keys {', '.join(LOADS)}")
        if len(kinds) > 1:
            raise wrong(kinds[-1], f"cannot be combined with {kinds[0]}; only one of them can be the load")
        return self

    def read(self, folder: Path, normal_force: float, friction: float) -> None:
        """Read the file that is named, if any, and refuse force amplitudes from mu F_N on, where the slip is gross.

        Args:
            folder: Where names of files begin.
            normal_force: F_N in N, unless a history has its own.
            friction: mu, unless a history has its own.
        """
        limit = friction * normal_force
        if self.tangential_force is not None and not self.tangential_force < limit:
            text = f"this is gross slip, F_x = {self.tangential_force:g} N is not below mu F_N = {limit:g} N"
            raise wrong("tangential_force", f"{text}; lower it, or raise friction or normal_force")
        if self.table is None and self.history is None:
            return
        from plgwear_jax import tables  # imports NumPy, which a scene with one amplitude does not need

        try:
            if self.table is not None:
                self._read = tables.read_table(folder / self.table)
            else:
                assert self.history is not None
                self._read = tables.read_history(folder / self.history)
            if not self.of_displacement:
                force, mu = self._read.normal_force, self._read.friction
                force, mu = (own if own is not None else one for own, one in ((force, normal_force), (mu, friction)))
                self._read.refuse_from(mu * force)
        except tables.TableError as error:  # the error is in another file than the scene
            raise PydanticCustomError("table", "{line}", {"line": str(error)}) from None

    def belongs_to(self, material: Material | Tabulated | Layers, contact: Fretting, wear: "Wear | None") -> None:
        """Say which contact a displacement moves; the force is computed when it is asked for."""
        self._contact = material, contact, wear

    @property
    def of_displacement(self) -> bool:
        """The amplitudes are those of the displacement."""
        return self.displacement is not None or (self._read is not None and self._read.column == "displacement")

    @property
    def given(self) -> "np.ndarray":
        """The amplitudes as they were given, in N or m, shape (n,): the one, or all of a history or a table."""
        import numpy as np

        if self._read is not None:
            return self._read.amplitude
        return np.array([self.tangential_force if self.displacement is None else self.displacement], float)

    @property
    def cycles(self) -> "np.ndarray | None":
        """How many cycles each amplitude of a history lasts, shape (n,); None if nothing says so."""
        return None if self._read is None else self._read.cycles

    @property
    def pressed(self) -> "dict[str, np.ndarray]":
        """The normal forces in N and the coefficients of friction that a history has of its own, each of shape (n,)."""
        if self._read is None:
            return {}
        own = {"normal_force": self._read.normal_force, "friction": self._read.friction}
        return {name: values for name, values in own.items() if values is not None}

    @property
    def is_zero(self) -> bool:
        """Nothing moves, and so nothing wears."""
        if self._read is None:
            return not (self.tangential_force or self.displacement)
        counting = self._read.amplitude if self._read.weight is None else self._read.amplitude[self._read.weight > 0.0]
        return not counting.any()

    @cached_property
    def moved(self) -> "Moved":
        """What the displacements of `given` do to the unworn contact."""
        assert self._contact is not None
        from plgwear_jax.scene import solving

        material, contact, _ = self._contact
        pressed = solving.homogeneous(solving.contact_of(material, contact.model_copy(update=self.pressed)))
        return solving.moved(pressed, self.given, self.rig_stiffness)

    @property
    def in_gross_slip(self) -> "np.ndarray":
        """Which amplitudes of `given` make the unworn contact slip as a whole, shape (n,)."""
        import numpy as np

        if not self.of_displacement:
            return np.zeros(self.given.shape, bool)
        return ~(self.given < np.asarray(self.moved.gross_slip))

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
        force, limit = np.asarray(self.moved.force), float(self.moved.gross_slip)
        (beyond,) = np.nonzero(self.in_gross_slip)
        if not beyond.size:
            return force
        displacement = float(self.given[beyond[0]])
        if self._read is None:
            place, error = "[load] displacement", SceneError
        else:
            error = OtherFileError
            place = f"{self._read.name}: row {self._read.row[beyond[0]]}: displacement"
        begins = f"from {limit:.4g} m on the {'contact' if self.rig_stiffness is None else 'rig'} slips as a whole"
        path = float(np.asarray(self.moved.path)[beyond[0]])
        worn = wear.worn_by_sliding(path, contact) if wear is not None and wear.exponent is None else None
        worn = worn or f"{contact.normal_force * path:.4g} N m times the wear coefficient"
        sliding = (
            f"by Archard's law such sliding wears {worn} a cycle at first; plgwear wear follows it over the cycles"
        )
        raise error(f"{place} = {displacement:g}: this is gross slip, {begins}; {sliding}")

    @property
    def amplitudes(self) -> "np.ndarray":
        """Amplitudes in N, shape (n,): the one amplitude, all of a history, or those of a table with weight > 0."""
        weight = None if self._read is None else self._read.weight
        return self.forces if weight is None else self.forces[weight > 0.0]

    @property
    def weights(self) -> "np.ndarray | None":
        """Weights of the amplitudes of a table, > 0, shape (n,), with the sum 1; None if there is no table."""
        if self._read is None or self._read.weight is None:
            return None
        from plgwear_jax.optimise.scenarios import shares

        return shares(self._read.weight[self._read.weight > 0.0])

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
            if self.in_gross_slip.any():
                begins = f"the contact slips as a whole, from {float(self.moved.gross_slip):.4g} m on"
                return f"displacement {self.displacement:g} m{whose}: {begins}"
            force = f"a force amplitude of {self.largest:.4g} N before wear"
            return f"displacement {self.displacement:g} m{whose}: {force}"
        if self.history is None or self._read is None:
            return None
        number = "1 amplitude" if self.forces.size == 1 else f"{self.forces.size} amplitudes"
        row = self._read.row[self.forces.argmax()]
        deciding = f"the largest, {self.largest:g} N (row {row}), decides the worn state"
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
        for name in ("exponent", "half_space_coefficient"):
            if getattr(self, name) is not None and self.coefficient is None:
                raise wrong(name, f"cannot be combined with {there[0]}; give coefficient, in 1/Pa or 1/Pa^exponent")
        return self

    def archard(self, friction: float) -> float:
        """Archard's wear coefficient in 1/Pa; from an energy coefficient it is that times the coefficient of friction.

        Args:
            friction: The coefficient of friction.

        Raises:
            SceneError: The section has another wear law, or wear of the half-space.
        """
        for name in ("exponent", "half_space_coefficient"):
            if getattr(self, name) is not None:
                raise SceneError(f"[wear] {name} = {getattr(self, name):g}: only plgwear wear takes it")
        if self.coefficient is not None:
            return self.coefficient
        if self.coefficient_mm3_per_N_m is not None:
            return self.coefficient_mm3_per_N_m / 1e9
        assert self.energy_coefficient_mm3_per_J is not None
        return friction * self.energy_coefficient_mm3_per_J / 1e9

    def worn_by_sliding(self, path: float, contact: Fretting) -> str:
        """What the first cycle of sliding wears, in words.

        Args:
            path: The way of this cycle in m.
            contact: The contact, which slides as a whole.
        """
        return f"{self.archard(contact.friction) * contact.normal_force * path:.4g} m^3"


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
    distance: float | None = Field(
        None,
        gt=0.0,
        allow_inf_nan=False,
        description="must be a finite number > 0, the distance inside the edge at which pressures are given, in m",
    )
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
