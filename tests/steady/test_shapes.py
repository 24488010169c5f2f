"""Indenters f(r) = r^n/(n R^(n-1))."""

import dataclasses

import jax
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import gamma

from plgwear_jax import DepthGraded, Elastic, FrettingContact, Layered, PowerShape, scene

R, FORCE, FRICTION = 5e-3, 10.0, 0.4
HALF_SPACE = DepthGraded([1e-6, 1e-3], [110e9, 110e9], 0.3)
STEEL = Elastic(210e9, 0.3)
LAYERS = FrettingContact(Layered([2e-5, 3e-5], [400e9, 200e9, 110e9], 0.3), R, FORCE, FRICTION, STEEL)
STEADY = "contact_radius", "stick_radius", "worn_radius", "penetration", "wear_volume"
SHAPED = dataclasses.replace(LAYERS, shape=PowerShape(4.0))


def by_dimension_reduction(n: float, phi: float) -> tuple[float, ...]:
    """STEADY of a rigid indenter on a homogeneous half-space, by the profile g of Popov and Hess."""
    plane, g = 110e9 / (1.0 - 0.3**2), 0.5 * np.sqrt(np.pi) * gamma(0.5 * n) / gamma(0.5 * (n + 1.0)) * R ** (1.0 - n)

    def radius(force):
        return (force * (n + 1.0) / (2.0 * plane * g * n)) ** (1.0 / (n + 1.0))

    a, c = radius(FORCE), radius((1.0 - phi) * FORCE)
    d = (FORCE / (2.0 * plane) + g * c ** (n + 1.0) / (n + 1.0)) / c

    def worn(r):
        pressed = quad(lambda t: d - g * (r * np.sin(t)) ** n, 0.0, np.arcsin(c / r), epsabs=0.0, epsrel=1e-12)[0]
        return d - 2.0 / np.pi * pressed - r**n / (n * R ** (n - 1.0))

    end = brentq(worn, a, 4.0 * a, xtol=1e-16)
    # By u = sqrt(r - c), of which the depth is a smooth function.
    volume = quad(lambda u: 4.0 * np.pi * u * (c + u * u) * worn(c + u * u), 0.0, np.sqrt(end - c), epsrel=1e-10)[0]
    return a, c, end, d, volume


@pytest.mark.compiled
@pytest.mark.parametrize("n", [2.5, 4.0, pytest.param(8.0, marks=pytest.mark.long)])
def test_on_a_homogeneous_half_space_it_is_that_of_dimension_reduction(n):
    contact, shares = FrettingContact(HALF_SPACE, R, FORCE, FRICTION, shape=PowerShape(n)), np.array([0.05, 0.6])
    exact = np.array([by_dimension_reduction(n, phi) for phi in shares]).T
    steady = contact.steady(shares * FRICTION * FORCE)
    for name, expected in zip(STEADY, exact, strict=True):
        np.testing.assert_allclose(getattr(steady, name), expected, rtol=1e-5, err_msg=name)
    a, r = exact[0, 0], exact[0, 0] * np.array([0.05, 0.5, 0.95])
    # g' of the same profile.
    slope = 0.5 * np.sqrt(np.pi) * n * gamma(0.5 * n) / gamma(0.5 * (n + 1.0)) * R ** (1.0 - n)

    def pressed(r):
        return quad(lambda u: slope * np.hypot(r, u) ** (n - 2.0), 0.0, np.sqrt(a * a - r * r))[0]

    expected = [110e9 / (1.0 - 0.3**2) / np.pi * pressed(x) for x in r]
    np.testing.assert_allclose(contact.steady(0.0).initial_pressure(r), expected, rtol=5e-4)


@pytest.mark.compiled
def test_a_traced_exponent_outside_gives_nan():
    def volume(n):
        return dataclasses.replace(LAYERS, shape=PowerShape(n)).steady(1.5).wear_volume

    assert np.isnan(jax.jit(volume)(0.5))


def test_what_is_refused():
    for exponent in (0.5, np.inf, np.nan):
        with pytest.raises(ValueError, match=f"exponent = {exponent} is outside the allowed range exponent >= 1"):
            PowerShape(exponent)
    with pytest.raises(TypeError, match=r"shape takes a Shape such as PowerShape.* not 4"):
        FrettingContact(HALF_SPACE, R, FORCE, FRICTION, shape=4)  # pyright: ignore[reportArgumentType]


LAYERED = "thickness = [2e-5, 3e-5]\nmodulus = [400e9, 200e9, 110e9]"
SCENE = f"""
[material]
{LAYERED}
nu = 0.3
[contact]
kind = "fretting"
radius = 5e-3
normal_force = 10.0
friction = 0.4
indenter = {{ E = 210e9, nu = 0.3 }}
shape = {{ kind = "power", exponent = 4 }}
[load]
tangential_force = 1.5
"""


def test_a_scene_takes_it(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text(SCENE)
    contact = scene.load(file).build_contact()
    assert isinstance(contact, FrettingContact) and contact.shape == PowerShape(4.0)
    for right, wrong, told in (
        ("power", "pyramid", "shape = .*must be"),
        ("= 4", "= 0.5", "shape = .*must be"),
    ):
        file.write_text(SCENE.replace(LAYERED, "E0 = 110e9\nz0 = 1e-4\nk = 0.2").replace(right, wrong))
        with pytest.raises(scene.SceneError, match=rf"\[contact\] {told}"):
            scene.load(file)
