"""The test over cycles that a scene describes. Not in `scene`, which has to check a file without JAX."""

import numpy as np

from plgwear_jax.contact import FrettingContact
from plgwear_jax.loads import Block, Displacement, Force
from plgwear_jax.scene.material_section import Layers, Material, Tabulated
from plgwear_jax.scene.sections import Fretting, Load, Wear
from plgwear_jax.wear_laws import Archard, PressurePower, WearLaw


def law_of(wear: Wear, contact: Fretting) -> WearLaw:
    """The wear law of the section [wear]; its coefficient is the sum over both bodies."""
    if wear.coefficient is None:
        return Archard(wear.archard(contact.friction))
    total = wear.coefficient + (wear.half_space_coefficient or 0.0)
    return Archard(total) if wear.exponent in (None, 1.0) else PressurePower(total, wear.exponent)


def load_of(load: Load) -> Force | Displacement | list[Block]:
    """What the section [load] gives in a test over cycles: an amplitude, or the blocks of a history."""
    kind = Displacement if load.of_displacement else Force
    amplitudes = [kind(amplitude, load.rig_stiffness) for amplitude in load.given.tolist()]
    if load.cycles is None:
        (amplitude,) = amplitudes
        return amplitude
    own = {name: values.tolist() for name, values in load.pressed.items()}
    blocks = enumerate(zip(amplitudes, load.cycles.tolist(), strict=True))
    return [Block(*block, **{name: values[i] for name, values in own.items()}) for i, block in blocks]


def least_gradient(material: Material | Tabulated | Layers, contact: FrettingContact) -> float:
    """The least depth in m over which the modulus changes: a layer, a spacing of a table, a_0 of a power law."""
    if isinstance(material, Material):
        return float(contact.steady(0.0).contact_radius) if material.k != 0.0 else np.inf
    if isinstance(material, Tabulated):
        return float(np.diff(material.read.depth).min())
    return min(material.thickness, default=np.inf)
