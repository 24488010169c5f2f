"""The figures and tables of the paper, drawn by the library, with checks of the statements of the paper.

Each function draws one figure for print; `FIGURES` lists them with the statements of the text that belong to them, and
`numbers` computes the numbers of the text. Needs the extra `plots`, and `jax_enable_x64` for all digits.
"""

from plgwear_jax.plots.figures.claims import FIGURES, Claim, PaperFigure, verdict
from plgwear_jax.plots.figures.pages import contact_sheet, report
from plgwear_jax.plots.figures.section_2 import (
    effective_volume_change,
    force_tendencies,
    gross_slip_set_up,
    normal_forces,
    punch_on_compliant_surface,
    punch_on_stiff_surface,
)
from plgwear_jax.plots.figures.section_3 import (
    edge_radii,
    fretting_set_up,
    gradients_of_equal_contact,
    limiting_profiles,
    wear_volumes,
    worn_pressures,
)
from plgwear_jax.plots.figures.text_numbers import NUMBERS, Asked, numbers

__all__ = [
    "FIGURES",
    "NUMBERS",
    "Asked",
    "Claim",
    "PaperFigure",
    "contact_sheet",
    "edge_radii",
    "effective_volume_change",
    "force_tendencies",
    "fretting_set_up",
    "gradients_of_equal_contact",
    "gross_slip_set_up",
    "limiting_profiles",
    "normal_forces",
    "numbers",
    "punch_on_compliant_surface",
    "punch_on_stiff_surface",
    "report",
    "verdict",
    "wear_volumes",
    "worn_pressures",
]
