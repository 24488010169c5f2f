"""What `plgwear design` says about a design for a number of cycles."""

from typing import TYPE_CHECKING, Any

from plgwear_jax.cli.question import UNITS
from plgwear_jax.cli.terminal import counted, measure

if TYPE_CHECKING:
    from plgwear_jax.optimise import Design, ForEver
    from plgwear_jax.scene import Scene

__all__ = ["life_as_json", "life_lines"]


def life_lines(given: "Scene", found: "Design", forever: "ForEver | None") -> list[str]:
    """What the design does for ever, and beside which number of cycles the choice would flip."""
    if given.life is None:
        of_another = given.wear is not None and given.wear.cycles is not None
        return ["cycles: only wear_volume is designed for a life; this is for the steady state"] if of_another else []
    if forever is None:
        return []
    cycles = given.life[1]
    worn = f"for ever it wears {measure(forever.volume, 'm^3')}, the reference"
    worn = f"{worn} {measure(forever.reference_volume, 'm^3')}"
    if forever.flips_at is None:
        return [f"{worn}; no other coating wears less for ever"]
    best = ", ".join(f"{name} = {measure(value, UNITS[name])}" for name, value in forever.best.variables.items())
    times = forever.best_by_then / float(found.value)
    return [
        f"{worn}, and the best coating for ever, {best}, wears {measure(float(forever.best.value), 'm^3')}",
        f"beyond {counted(float(f'{forever.flips_at * cycles:.3g}'))} cycles that one wears less; "
        f"after {counted(cycles)} it has worn {times:.3g} times as much",
    ]


def life_as_json(life: tuple[float, float], found: "Design", forever: "ForEver") -> dict[str, Any]:
    """The same as an object."""
    coefficient, cycles = life
    return {
        "wear_coefficient": coefficient,
        "cycles": cycles,
        "volume": float(found.value),
        "volume_for_ever": forever.volume,
        "reference_volume_for_ever": forever.reference_volume,
        "best_for_ever": {"variables": forever.best.variables, "volume": float(forever.best.value)},
        "best_for_ever_by_then": forever.best_by_then,
        "flips_at_cycles": None if forever.flips_at is None else forever.flips_at * cycles,
    }
