"""The two contacts of the paper in SI units.

Both are pytrees: `jax.grad` of a quantity with respect to the contact gives a contact whose fields (k, z0, E0 and so
on) are derivatives. Fields may be arrays that broadcast against each other and against the load.
"""

from .fretting_contact import FrettingContact, is_closed
from .gross_slip_contact import GrossSlipContact, SteadyPunch
from .regimes import CRITERIA, SlipRegimes, slip_regimes

__all__ = ["CRITERIA", "FrettingContact", "GrossSlipContact", "SlipRegimes", "SteadyPunch", "is_closed", "slip_regimes"]
