"""How finely the contact is divided for a number of digits."""

from typing import NamedTuple

from plgwear_jax._core.domains import whole


class Effort(NamedTuple):
    """Sizes, none of them a traced number."""

    digits: int
    modes: int  # pressures of the contact
    spacing: float  # of the logarithms of wavenumbers
    nodes: int  # of an integral over the ring, or over what is inside


# Measured: docs/benchmarks/surfaces.txt.
EFFORTS = {
    2: Effort(2, 14, 0.25, 28),
    3: Effort(3, 24, 0.22, 40),
    4: Effort(4, 44, 0.2, 40),
    5: Effort(5, 56, 0.16, 56),
}


def effort_of(digits: int | None) -> Effort:
    """The effort for these digits; 4 by default."""
    known = whole("digits", 4 if digits is None else digits, 1, max(EFFORTS), " of numeric contacts")
    return EFFORTS[max(known, min(EFFORTS))]
