"""How finely the contact is divided for a number of digits."""

from typing import NamedTuple

__all__ = ["Effort", "effort_of"]


class Effort(NamedTuple):
    """Sizes, none of them a traced number."""

    digits: int
    modes: int  # pressures of the contact
    spacing: float  # of the logarithms of wavenumbers
    least: float  # wavenumber in units of one over the radius, below which the compliance is constant
    most: float  # above which it is that of the surface
    nodes: int  # of an integral over the ring, or over what is inside


# Measured: docs/benchmarks/surfaces.txt.
EFFORTS = {
    2: Effort(2, 12, 0.25, 1e-3, 1e3, 28),
    3: Effort(3, 20, 0.25, 3e-4, 4e3, 40),
    4: Effort(4, 28, 0.22, 3e-4, 4e3, 40),
    5: Effort(5, 40, 0.2, 1e-4, 1e4, 56),
}


def effort_of(digits: int | None) -> Effort:
    """The effort for these digits; 4 by default."""
    most = max(EFFORTS)
    if digits is not None and digits > most:
        raise ValueError(f"digits = {digits} is outside the allowed range 1 <= digits <= {most} of numeric contacts")
    return EFFORTS[max(4 if digits is None else digits, min(EFFORTS))]
