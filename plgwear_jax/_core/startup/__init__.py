"""What only shortens the start: results are the same without it.

The variable PLGWEAR_STARTUP switches it off: empty all of it, or else it names the parts that are wanted, with commas
between them.
"""

import os


def on(part: str) -> bool:
    """Whether a part is wanted: by default each of them is."""
    wanted = os.environ.get("PLGWEAR_STARTUP")
    return wanted is None or part in wanted.split(",")
