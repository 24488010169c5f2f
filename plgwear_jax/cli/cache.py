"""The cache of compiled programs, which keeps them for the next command in the user's cache folder, up to a size.

A command that answers one question keeps its programs (`startup.programs`). All others let JAX's cache read, write and
evict. This module decides where programs are kept, how many, and when none are. A fault of the folder must neither
change a result nor reach the user.
"""

import os
import stat
import warnings
from pathlib import Path

# Bytes, for `startup.programs` and for JAX each. For every new program JAX looks at all files that it keeps, about 100
# per MB, so a much larger cache would cost more time than it saves.
MOST = 8 * 2**20

# If one of JAX's own variables for its cache is set, the cache is left to JAX.
_OF_JAX = ("JAX_COMPILATION_CACHE", "JAX_ENABLE_COMPILATION_CACHE", "JAX_PERSISTENT_CACHE")


def use(one_question: bool) -> None:
    """Keep compiled programs, unless the user decides otherwise or the folder cannot be used.

    Args:
        one_question: See `terminal.computing`.
    """
    import jax

    from plgwear_jax._core.startup import on, programs

    programs.keep_in(None)
    known = jax.config.jax_compilation_cache_dir  # pyright: ignore[reportAttributeAccessIssue]
    if known or any(name.startswith(_OF_JAX) for name in os.environ):
        return
    place = _prepared()
    if place is None:
        return
    if one_question and on("kept"):
        programs.keep_in(place / "programs", MOST)
        return
    settings = {
        "jax_compilation_cache_dir": str(place),
        "jax_compilation_cache_max_size": MOST,
        "jax_persistent_cache_min_compile_time_secs": 0.0,  # a design has many small programs
        "jax_persistent_cache_min_entry_size_bytes": -1,
        "jax_persistent_cache_enable_xla_caches": "none",  # these are not bounded
    }
    for name, value in settings.items():
        jax.config.update(name, value)
    # With a full disk, a damaged file or a program too large JAX compiles; the user need not know.
    for said in ("Error (reading|writing) persistent compilation cache", "Cache value for key .* exceeds"):
        warnings.filterwarnings("ignore", said, UserWarning)


def _prepared() -> Path | None:
    """The folder, ready to be written to; None if it cannot be, or if others can: the files are executed."""
    import filelock
    import platformdirs

    try:
        place = platformdirs.user_cache_path("plgwear", appauthor=False)
        place.parent.mkdir(exist_ok=True)  # only one level: a missing home folder is not made
        place.mkdir(mode=0o700, exist_ok=True)
        about = place.stat()
        if hasattr(os, "getuid") and (about.st_uid != os.getuid() or about.st_mode & (stat.S_IWGRP | stat.S_IWOTH)):
            return None
        with filelock.FileLock(place / ".lockfile", timeout=1.0):  # JAX's own
            # Half-written programs lack the file with their time of use, without which JAX stops writing.
            for program in place.glob("*-cache"):
                if not program.with_name(f"{program.name.removesuffix('cache')}atime").exists():
                    program.unlink(missing_ok=True)
    except (OSError, RuntimeError, NotImplementedError):  # also: no home, no locks on this disk
        return None
    return place
