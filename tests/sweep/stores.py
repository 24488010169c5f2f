"""A small sweep into a store, how it is stopped, and what is then there."""

import functools

import numpy as np
from refusals import refusal

from plgwear_jax.sweep import SweepError, sweep

QUANTITIES = ["stick_radius", "stick_radius.dk", "gross_slip.force_ratio"]
AXES = {"k": np.linspace(-0.9, 0.9, 40), "phi": np.linspace(0.01, 0.99, 30)}
CHUNKS = 12


def into(out, **changes):
    return sweep(**({"quantities": QUANTITIES, "chunk": 100, "out": out} | AXES | changes))


refused = functools.partial(refusal, SweepError)


def files(path):
    """Every file, what identifies it, when it was written and all that it holds."""
    found = {}
    for file in sorted(path.rglob("*")) if path.is_dir() else [path]:
        status = file.lstat()
        found[str(file)] = (status.st_ino, status.st_mtime_ns, file.read_bytes() if file.is_file() else None)
    return found


def held(path):
    """All that the files hold."""
    return {name: content for name, (_, _, content) in files(path).items() if content is not None}


class Stop:
    """A progress that stops the sweep after some chunks, or only counts them."""

    def __init__(self, after=10**9, error=None):
        self.after, self.error, self.done = after, error, []

    def __call__(self, done, points):
        assert points == 1200
        self.done.append(done)
        if len(self.done) > self.after and self.error is not None:
            raise self.error

    @property
    def chunks(self):
        return len(self.done) - 1  # the first tells what was there
