"""Settings that all tests share."""

import os

import jax
import pytest
from hypothesis import HealthCheck, settings

# The caller's choice, and here the tests are the caller; the library itself never touches it.
jax.config.update("jax_enable_x64", True)

settings.register_profile("default", deadline=None, max_examples=60, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("long", parent=settings.get_profile("default"), max_examples=2000)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "default"))


@pytest.fixture(scope="session")
def seed() -> int:
    """A seed for random points, fresh on every day unless PLGWEAR_SEED fixes it; printed with every failure."""
    return int(os.environ.get("PLGWEAR_SEED", "20240229"))
