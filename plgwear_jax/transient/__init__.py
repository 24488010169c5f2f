"""Wear over cycles: how the fretting contact runs into its steady state, without units.

By Archard's law with a wear coefficient K, the depth worn in a cycle is K times the pressure times four slip
amplitudes. Under a constant normal force and a constant amplitude of the tangential force the stick radius c is
constant, and the wear depends on k, phi and one more number, the reduced cycles

    n = 4 K mu theta F_N N/(pi a_0^2)

for N cycles, with theta of `material.tangential_ratio`. Radii are in units of a_0, heights in a_0^2/R, volumes in
a_0^4/R and pressures in F_N/(pi a_0^2). `docs/explanation/numerics.md` derives the equations that are solved here:
in T = r^2, with h the worn depth, p the pressure, P its integral over n, g the gap outside the unworn contact of
radius c and H the steady depth,

    g (exp(P) - 1) + A p = H where p > 0,        g (exp(P) - 1) + A p >= H where p = 0,

A symmetric, positive, and p >= 0: the gradient flow of a convex function under a constraint. The contact grows, and
each step ends when its edge has reached the next cell.
"""
