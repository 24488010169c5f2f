"""Partial slip in SI units: the only place that chooses between closed forms and numerical solutions.

The types of the bodies decide alone. What solves a contact is imported by the first one that needs it.
"""

from typing import TYPE_CHECKING, Any, ClassVar

from plgwear_jax._core.domains import POSITIVE, ArrayLike, Numbers, record
from plgwear_jax.loads import load_of
from plgwear_jax.material import HalfSpace, PowerLawGraded
from plgwear_jax.shapes import shape_of
from plgwear_jax.shapes.powers import Parabola
from plgwear_jax.shapes.shape import Shape
from plgwear_jax.steady.closed import Steady
from plgwear_jax.wear_laws import Archard, WearLaw, law_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from plgwear_jax.loads import Block, Load
    from plgwear_jax.surfaces import Elastic
    from plgwear_jax.wear.run import Run


def is_closed(contact: Any) -> bool:
    """Whether a contact has closed forms: a rigid parabola or punch on a power law, or two homogeneous bodies."""
    if not isinstance(shape_of(contact), Parabola):
        return False
    if isinstance(contact.material, PowerLawGraded):
        return getattr(contact, "indenter", None) is None
    from plgwear_jax.surfaces import Elastic

    return isinstance(contact.material, Elastic)


def check_fretting_contact(contact: Any) -> None:
    """Check that a contact is one of fretting."""
    if not isinstance(contact, FrettingContact):
        raise TypeError(f"contact takes a FrettingContact, not {contact!r}")


@record
class FrettingContact:
    """An indenter under a constant normal and an oscillating tangential force: section 3 of the paper, and beyond.

    The indenter wears, the half-space does not. A power law under a rigid parabola has the paper's closed forms, and so
    have two homogeneous bodies under a parabola, whose plane moduli are combined. Any other contact is solved
    numerically, to 2 to 5 `digits`, by default 4 (one digit is computed as two), and its tangential compliance is
    taken as proportional to the normal one. Over cycles these contacts have 2 to 4 digits. The types of the bodies
    decide, not their values.

    It answers by two methods: `steady` for one load, and `over_cycles` for the way there.

    Attributes:
        material: The half-space: a `PowerLawGraded`, a `DepthGraded` of any modulus, a `Layered`, or an `Elastic`.
        radius: Radius of curvature R of the indenter, in m, positive.
        normal_force: Normal force F_N in N, positive.
        friction: Coefficient of friction mu, positive.
        indenter: An `Elastic` body; rigid if None.
        shape: A `Shape`; a parabola if None.

    Raises:
        ValueError: A concrete field is outside its range. Under `jit` results are NaN there.

    Examples:
        >>> import jax
        >>> from plgwear_jax import FrettingContact, PowerLawGraded
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> print(f"{contact.steady(0.0).contact_radius:.3e} m")
        6.770e-05 m
        >>> slope = jax.grad(lambda contact: contact.steady(2.0).wear_volume)(contact)
        >>> print(slope.normal_force < 0)  # a larger normal force wears less
        True

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eqs. (11) to (28); other bodies and shapes:
        `docs/explanation/numerics.md`, "Elastic indenters and any E(z)".
    """

    ranges: ClassVar = dict.fromkeys(("radius", "normal_force", "friction"), POSITIVE)

    material: Any
    radius: Numbers
    normal_force: Numbers
    friction: Numbers
    indenter: "Elastic | None" = None
    shape: Shape | None = None

    def __post_init__(self) -> None:
        if isinstance(self.material, PowerLawGraded) and self.indenter is None and self.shape is None:
            return
        from plgwear_jax.surfaces import Elastic

        if not isinstance(self.material, HalfSpace):
            kinds = "a PowerLawGraded, a DepthGraded, a Layered or an Elastic"
            raise TypeError(f"material takes {kinds}, not {self.material!r}")
        if not isinstance(self.indenter, Elastic | None):
            raise TypeError(f"indenter takes an Elastic, or None for a rigid one, not {self.indenter!r}")
        if not isinstance(self.shape, Shape | None):
            raise TypeError(f"shape takes a Shape such as PowerShape(4), or None for a parabola, not {self.shape!r}")

    def steady(self, load: "ArrayLike | Load", *, digits: int | None = None) -> Steady:
        """The contact under a load, unworn and worn to its steady state: see `Steady`.

        To get several quantities, read them all from this object: a numerical contact is then solved only once.

        Args:
            load: A force amplitude F_x in N, 0 <= F_x < mu F_N, or a load of `loads`: a `Displacement` is the force
                amplitude that it needs before any wear.
            digits: Correct digits wanted; by default all that the solver has.
        """
        if is_closed(self):
            return Steady(self, load_of(load), digits=digits)
        from plgwear_jax.steady.numeric import NumericSteady

        return NumericSteady(self, load_of(load), digits=digits)

    def over_cycles(
        self, load: "ArrayLike | Load | Sequence[Block]", law: ArrayLike | WearLaw, *, digits: int | None = None
    ) -> "Run":
        """The wear over cycles, from the unworn contact on: see `Run`.

        A constant force amplitude under Archard's law has up to 5 digits. All other tests have about 2: a
        displacement amplitude, also one of gross slip, blocks of cycles, other wear laws.

        Args:
            load: A constant force amplitude F_x in N, a load of `loads`, or a list of `loads.Block`.
            law: Archard's wear coefficient K in 1/Pa, or a law of `wear_laws`.
            digits: Correct digits wanted of the volume: for a constant force under Archard's law 2 to 5 with closed
                forms and 2 to 4 with numerical contacts, by default 4; for any other test 2. One digit is computed
                as two.
        """
        if not isinstance(law, WearLaw) and (isinstance(law, str | type | None) or callable(law)):
            raise TypeError(f"law takes a wear coefficient K in 1/Pa or an instance of a WearLaw, not {law!r}")
        load, law = load_of(load), law_of(law)
        if not (load.holds_force and isinstance(law, Archard)):
            from plgwear_jax.wear.marched import MarchedRun as Engine
        elif is_closed(self):
            from plgwear_jax.wear.closed_ring import ClosedRun as Engine
        else:
            from plgwear_jax.wear.numeric_ring import NumericRun as Engine
        return Engine(self, load, law, digits)
