"""The two contacts of the paper in SI units, by the dimensionless functions of `gross_slip` and `fretting`.

Both are pytrees: `jax.grad` of a method with respect to the contact gives a contact whose fields (k, z0, E0 and so on)
are derivatives. Fields may be arrays that broadcast against each other and against the arguments.
"""

from plgwear_jax.contact.engines import check_closed, is_closed
from plgwear_jax.contact.fretting_contact import FrettingContact
from plgwear_jax.contact.gross_slip_contact import GrossSlipContact
from plgwear_jax.contact.over_cycles import (
    WearByBlocks,
    WearOverCycles,
    cycles_to_shares,
    reduced_cycles,
    wear_by_blocks,
    wear_over_cycles,
)
from plgwear_jax.contact.regimes import CRITERIA, SlipRegimes, slip_regimes
from plgwear_jax.shapes.of_contact import unworn_of
from plgwear_jax.steady.arguments import FORCE, PARTIAL_SLIP

__all__ = [
    "CRITERIA",
    "FORCE",
    "PARTIAL_SLIP",
    "FrettingContact",
    "GrossSlipContact",
    "SlipRegimes",
    "WearByBlocks",
    "WearOverCycles",
    "check_closed",
    "cycles_to_shares",
    "is_closed",
    "reduced_cycles",
    "slip_regimes",
    "unworn_of",
    "wear_by_blocks",
    "wear_over_cycles",
]
