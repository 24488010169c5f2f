"""A sweep in a process of its own, for tests that kill it or give it other devices: `python sweep_process.py JSON`.

The JSON holds the keywords of `sweep`, axes as start, stop and count. It tells, a JSON a line, the points done whenever
the sweep tells its progress, and at the end what XLA compiled. Without `out` the arrays go to `arrays`, a .npz.
"""

import json
import sys

import jax
import numpy as np

from plgwear_jax import sweep

KEYWORDS = {
    "quantities": ["wear_volume", "wear_volume.dk"],
    "chunk": 2500,
    "k": [-0.95, 0.95, 1290],
    "phi": [0.01, 0.99, 1283],
}


def tell(**said):
    print(json.dumps(said), flush=True)


def main():
    keywords = json.loads(sys.argv[1])
    jax.config.update("jax_enable_x64", keywords.pop("wide", True))
    arrays = keywords.pop("arrays", None)
    for name in ("k", "phi"):
        keywords[name] = np.linspace(*keywords[name])
    compiled = []

    def note(event, duration, **about):
        del duration
        if event.endswith("backend_compile_duration"):
            compiled.append(about.get("fun_name", event))

    jax.monitoring.register_event_duration_secs_listener(note)
    found = sweep.sweep(**keywords, progress=lambda done, points: tell(done=done, points=points))
    tell(compiled=compiled, devices=jax.local_device_count())
    if arrays:
        np.savez(arrays, **{name: found[name].values for name in found.data_vars})


if __name__ == "__main__":
    main()
