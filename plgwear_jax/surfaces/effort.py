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


EFFORTS = {
    2: Effort(2, 8, 0.45, 1e-3, 1e3, 20),
    3: Effort(3, 12, 0.35, 1e-3, 1e3, 28),
    4: Effort(4, 20, 0.25, 3e-4, 4e3, 40),
    5: Effort(5, 32, 0.2, 1e-4, 1e4, 48),
}


def effort_of(digits: int | None) -> Effort:
    """The effort for these digits; 4 by default."""
    most = max(EFFORTS)
    if digits is not None and digits > most:
        raise ValueError(f"digits = {digits} is outside the allowed range 1 <= digits <= {most} of numeric contacts")
    return EFFORTS[max(4 if digits is None else digits, min(EFFORTS))]
