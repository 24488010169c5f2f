"""Blocks of cycles of different amplitudes, against what is known of one amplitude."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from plgwear_jax import fretting, transient

ERROR = 1e-2  # promised, of the final volume at the largest amplitude
KS = (-0.5, 0.6)


@pytest.mark.parametrize("k", KS)
def test_growing_amplitudes_end_at_the_limit_of_the_largest(k):
    phi = np.array([0.2, 0.4, 0.6, 0.8])
    found = transient.blocks(k, phi, np.full(4, 1e4))
    final = float(fretting.wear_volume(k, 0.8))
    np.testing.assert_allclose(found.volume / final, fretting.wear_volume(k, phi) / final, atol=ERROR)
    np.testing.assert_allclose(found.stick_radius, fretting.stick_radius(k, phi), rtol=1e-6)
    np.testing.assert_allclose(found.contact_radius[-1], fretting.worn_radius(k, 0.8), rtol=0.01)


@pytest.mark.parametrize("k", KS)
def test_a_smaller_amplitude_afterwards_wears_no_more_than_the_larger(k):
    phi = np.array([0.7, 0.3, 0.7, 0.0])
    found = transient.blocks(k, phi, np.array([2.0, 1.0, 1e4, 5.0]))
    slow = float(found.volume[1] - found.volume[0])
    second, third = np.asarray(transient.wear_volume(k, 0.7, np.array([2.0, 3.0, 3.0, 3.0])))[:2]
    assert 0.0 < slow < 0.5 * (third - second)
    assert float(found.stick_radius[1]) > float(found.stick_radius[0])
    # All in all the largest amplitude decides, and without one nothing wears.
    assert float(found.volume[2]) == pytest.approx(float(fretting.wear_volume(k, 0.7)), rel=ERROR)
    assert float(found.wear_rate[3]) == 0.0 and float(found.volume[3] - found.volume[2]) == 0.0
    # After its steady state nothing is left for a smaller one.
    later = transient.blocks(k, np.array([0.7, 0.3, 0.5, 0.2]), np.array([1e4, 1e2, 1e2, 1e2]))
    assert float(later.volume[3] - later.volume[0]) < 1e-6


@pytest.mark.long
@pytest.mark.parametrize("k", [-0.9, 0.9])
def test_a_sequence_does_not_depend_on_the_cells(k, monkeypatch):
    from plgwear_jax.transient import sequence

    phi, n = np.array([0.5, 0.8, 0.3, 0.9, 0.6]), np.array([2.0, 1.0, 5.0, 1.0, 3.0])
    rough = transient.blocks(k, phi, n)
    for name in ("_UNWORN", "_OUTER", "_MOST", "_TOTAL"):
        monkeypatch.setattr(sequence, name, 2 * getattr(sequence, name))
    sequence._grid.cache_clear(), jax.clear_caches()
    fine = transient.blocks(k, phi, n)
    sequence._grid.cache_clear()
    final = float(fretting.wear_volume(k, 0.9))
    np.testing.assert_allclose(rough.volume / final, fine.volume / final, atol=ERROR)


@pytest.mark.compiled
def test_derivatives_and_nan():
    n, third = np.array([1.0, 2.0, 3.0, 40.0]), np.array([0.0, 0.0, 1.0, 0.0])

    @jax.jit
    def along(phi, moved):
        return jax.jvp(lambda phi: transient.blocks(0.6, phi, jnp.asarray(n)).volume[-1], [phi], [moved])

    phi = np.array([0.2, 0.5, 0.7, 0.3])
    ahead, behind = (float(transient.blocks(0.6, phi + step * third, n).volume[-1]) for step in (1e-3, -1e-3))
    assert float(along(phi, third)[1]) == pytest.approx((ahead - behind) / 2e-3, rel=0.03)
    assert np.isnan(along(np.array([0.2, 1.5, 0.7, 0.3]), third)[0])


@pytest.mark.parametrize(
    "call, said",
    [
        (lambda: transient.blocks(0.0, [0.5, 1.0], [1.0, 1.0]), "phi = 1.0 at index 1 is outside"),
        (lambda: transient.blocks(0.0, [0.5], [-1.0]), "n = -1.0 at index 0 is outside"),
        (
            lambda: transient.blocks(0.0, [0.5, 0.6], [1.0]),
            "phi and n take one number a block, not arrays",
        ),
        (lambda: transient.blocks(0.0, [], []), "phi and n take one number a block"),
        (lambda: transient.blocks([0.0, 0.1], [0.5], [1.0]), "k takes one number for all blocks"),
        (lambda: transient.blocks(0.0, [0.5], [1.0], control="u"), "control = 'u' is neither"),
    ],
)
def test_bad_input_is_refused(call, said):
    with pytest.raises(ValueError, match=said):
        call()
