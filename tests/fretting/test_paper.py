"""The paper's quantities in SI units; its equations are those of `oracle`, in `test_accuracy`."""

import numpy as np
import oracle
from functions import by_numpy
from marks import parametrize
from numpy.testing import assert_allclose
from refusals import data

from plgwear_jax import FrettingContact, GrossSlipContact, PowerLawGraded, fretting, gross_slip, partial_slip

EXPONENTS = (-0.8, -0.5, -0.2, 0.0, 0.3, 0.6, 0.8)
ROUNDING = 2e-14  # of a handful of double operations, a hundred units in the last place
SI = {"rtol": 2e-13, "atol": 0.0}  # a_0 is the exponential of a logarithm of some tens
E0, Z0, R, F_N, MU = 110e9, 2e-4, 5e-3, 12.0, 0.4
PHI = 0.3


@parametrize("nu", [0.0, 0.3, 0.5, "holl"])
@parametrize("k", EXPONENTS)
def test_forces_and_radii_are_those_of_equations_8_to_12(k, nu):
    graded, ratio = PowerLawGraded(E0, Z0, k, nu), 1.0 / (2.0 + k) if nu == "holl" else nu
    punch, at = GrossSlipContact(graded, radius=2e-3, depth=5e-6).steady(), (E0, Z0, k, ratio)
    initial, steady = (f(*at, 2e-3, 5e-6) for f in (oracle.gross_initial_force, oracle.gross_steady_force))
    found = punch.initial_force, punch.steady_force, punch.force_ratio, 1.0 - punch.force_drop
    assert_allclose(found, [float(x) for x in (initial, steady, *[steady / initial] * 2)], rtol=ROUNDING)
    a_0 = FrettingContact(graded, R, F_N, MU).steady(0.0).contact_radius
    assert_allclose(a_0, float(oracle.contact_radius(*at, R, F_N)), rtol=ROUNDING)


NUMBERS, FIELDS, BEFORE = data("fretting/units.toml").values()


def contact_and_dimensionless(k):
    """{name: (a quantity of a contact, the dimensionless one in its unit)}."""
    graded, r, distance = PowerLawGraded(E0, Z0, k, 0.3), np.array([0.0, 0.5, 0.93, 1.02, 1.5]), np.array([0.1, 3.0])
    steady, theta = FrettingContact(graded, R, F_N, MU).steady(PHI * MU * F_N), graded.tangential_ratio()
    a = steady.contact_radius
    unit = {"1": 1.0, "a": a, "h": a**2 / R, "V": a**4 / R, "p": F_N / (np.pi * a**2), "t": MU * F_N / (np.pi * a**2)}
    unit |= {"u": MU * theta * a**2 / R, "W": MU**2 * theta * F_N * a**2 / R}
    found = {"slip_amplitude": (steady.slip_amplitude(a * r), partial_slip.slip_amplitude(r, k, PHI) * unit["u"])}
    for name, scale in NUMBERS.items():
        module = fretting if hasattr(fretting, name) else partial_slip
        found[name] = getattr(steady, name), getattr(module, name)(k, PHI) * unit[scale]
    for name, scale in (FIELDS | BEFORE).items():
        at = (r, k) if name in BEFORE else (r, k, PHI)
        read = getattr(steady, name.removeprefix("steady_") if scale in "pt" else name)
        found[name] = read(a * r), getattr(fretting, name)(*at) * unit[scale]
    found["edge_pressure"] = steady.edge_pressure(a * distance), fretting.edge_pressure(distance, k, PHI) * unit["p"]
    return found | {"peak_initial_pressure": (steady.peak_initial_pressure, steady.initial_pressure(0.0))}


@parametrize("k", [-0.5, 0.3])
def test_quantities_of_a_contact_are_dimensionless_ones_in_si_units(k):
    found = by_numpy(contact_and_dimensionless)(np.asarray(k))
    for name, both in found.items():
        assert_allclose(*both, rtol=1e-12, atol=1e-30, err_msg=name)
    assert not np.any(np.asarray(found["slip_amplitude"][0])[[0, 3, 4]])  # where it sticks, and outside of the contact


def punch_and_dimensionless(k):
    """Of a punch, in the same way."""
    a, d = 2e-3, 5e-6
    steady, r = GrossSlipContact(PowerLawGraded(E0, Z0, k, 0.3), radius=a, depth=d).steady(), np.array([0.0, 0.5, 1.5])
    yield steady.volume_change, gross_slip.volume_change(k) * np.pi * a**2 * d
    for name, unit in (("displacement", d), ("pressure", steady.initial_force / (np.pi * a**2))):
        for field in (f"initial_{name}", f"steady_{name}"):
            yield getattr(steady, field)(a * r), getattr(gross_slip, field)(r, k) * unit


@parametrize("k", [-0.5, 0.3])
def test_quantities_of_a_punch_are_dimensionless_ones_in_si_units(k):
    for both in by_numpy(lambda k: [*punch_and_dimensionless(k)])(np.asarray(k)):
        assert_allclose(*both, **SI)
