"""The steady state of rigid indenters of any f(r) on a power law, by mpmath, importing nothing from the library.

With f' = sum of coefficients times powers of r in each piece between radii, s = (1+k)/2, sigma = sin(pi s)/pi,

    g(x)  = x^(1-k) times the integral over r from 0 to x of f'(r) (x^2-r^2)^((k-1)/2)
    F(a)  = 2 c_N times the integral over x from 0 to a of x^k (g(a) - g(x)),     F(a_0) = F_N,  F(c) = (1-phi) F_N
    d_inf = g(c) + phi F_N (1+k)/(2 c_N c^(1+k))
    h(r)  = sigma times the integral over T from c^2 to r^2 of T^(s-1) (r^2-T)^(-s) (d_inf - g(sqrt T)),    h(a_inf) = 0
    V     = pi sigma/(1-s) times that of T^(s-1) (a_inf^2-T)^(1-s) (d_inf - g(sqrt T)) up to a_inf^2.

Lengths are in any unit, forces in units of 2 c_N times lengths to the power 2 + k.
"""

from collections.abc import Sequence
from typing import NamedTuple

from mpmath import mp, mpf


class Piece(NamedTuple):
    """f'(r) = the sum of coefficient r^power from `begin` on up to the next piece."""

    begin: mpf
    terms: Sequence[tuple[mpf, mpf]]  # (coefficient, power)


class Oracle:
    """One shape at one k."""

    def __init__(self, pieces, k):
        self.pieces, self.k, self.s = list(pieces), mpf(k), (1 + mpf(k)) / 2
        self.kinks = [piece.begin for piece in self.pieces if piece.begin > 0]
        self._known = {}

    def g(self, x):
        if x not in self._known:
            self._known[x] = self._g(x)
        return self._known[x]

    def _g(self, x):
        total, s = mpf(0), self.s
        for place, piece in enumerate(self.pieces):
            if piece.begin >= x:
                break
            end = self.pieces[place + 1].begin if place + 1 < len(self.pieces) else x
            lower, upper = (piece.begin / x) ** 2, min(mpf(1), (end / x) ** 2)
            for coefficient, power in piece.terms:
                # By t = (r/x)^2, which leaves an incomplete beta function.
                total += coefficient * x**power * mp.betainc((power + 1) / 2, s, lower, upper) / 2
        return x * total

    def pressed(self, a):
        """F(a)/(2 c_N)."""
        n = 1 + self.k
        at = self.g(a)
        ends = [mpf(0), *(b**n for b in self.kinks if b < a), a**n]
        return mp.quad(lambda y: at - self.g(y ** (1 / n)), ends) / n

    def radius(self, force, start):
        """a with F(a) = 2 c_N times a number, by its logarithm, from the flat face on."""
        flat = self.pieces[0].begin if self.pieces else mpf(0)
        return flat + mp.exp(_root(lambda u: mp.log(self.pressed(flat + mp.exp(u)) / force), mp.log(start)))

    def beside(self, r, c, d, power):
        """The integral of T^(s-1) (r^2-T)^(power-1) (d - g), by v = (r^2-T)^power."""
        r2 = r * r

        def over(v):
            T = r2 - v ** (1 / power)
            return T ** (self.s - 1) * (d - self.g(mp.sqrt(T))) / power

        ends = [(r2 - b * b) ** power for b in reversed(self.kinks) if c < b < r]
        return mp.quad(over, [mpf(0), *ends, (r2 - c * c) ** power])

    def steady(self, force, phi, start):
        """(a_0, c, a_inf, d_inf, V) under a force over 2 c_N; `start` is about a_0, less the flat face."""
        phi = mpf(phi)
        a = self.radius(force, start)
        c = self.radius((1 - phi) * force, (a - self.pieces[0].begin) * (1 - phi) ** mpf("0.4"))
        d = self.g(c) + phi * force * (1 + self.k) / c ** (1 + self.k)
        q = 1 - self.s
        start = mp.log(a * a * (1 + phi / 10) - c * c)

        def depth(u):
            y = mp.exp(u)
            return -self.beside(mp.sqrt(c * c + y), c, d, q) / y**q

        end = mp.sqrt(c * c + mp.exp(_root(depth, start)))
        # sigma/(1-s), and the integral of (r^2-T)^(1-s) by that of the power 2 - s.
        volume = mp.sin(mp.pi * self.s) * self.beside(end, c, d, 1 + q) / q
        return a, c, end, d, volume


def _root(function, start):
    """The zero of a function that rises from below zero to above it, bracketed before it is refined.

    A secant from the start alone leaves the domain where the slope is small.
    """
    here, at = start, function(start)
    step = mpf("-0.1" if at > 0 else "0.1")
    for _ in range(40):
        there = here + step
        beyond = function(there)
        if beyond * at <= 0:
            return mp.findroot(function, (here, there), solver="anderson", tol=mpf(10) ** (4 - mp.dps), verify=False)
        here, at, step = there, beyond, 2 * step
    raise ValueError("the function has no zero")
