"""Tables of E(z) that are steep: against the plane-strain equations, and finer divisions."""

import jax.numpy as jnp
import numpy as np
import surface_oracle
from scipy.interpolate import PchipInterpolator

from plgwear_jax.special.pchip import pchip
from plgwear_jax.surfaces.half_space import excess_compliance

DEPTH = np.array([0.142, 0.27, 0.324, 0.541, 3.162, 9.672])
MODULUS = np.array([0.229, 3.444, 3.273, 4.189, 1.007, 0.706])
NU = 0.3


def test_a_steep_table_has_the_compliance_of_the_equations():
    q = np.array([0.12, 1.5, 6.0, 18.0])
    cubic = PchipInterpolator(DEPTH, MODULUS)
    exact = [
        surface_oracle.excess(
            lambda z: float(cubic(np.clip(z, DEPTH[0], DEPTH[-1]))), NU, DEPTH[-1], list(DEPTH), float(x)
        )
        for x in q
    ]
    table = pchip(jnp.asarray(DEPTH), jnp.asarray(MODULUS))
    for digits, error in ((3, 1e-3), (4, 3e-4), (5, 3e-5)):
        found = excess_compliance(table, jnp.asarray(NU), jnp.asarray(q), digits)
        np.testing.assert_allclose(1.0 + found, 1.0 + np.array(exact), rtol=error)
