"""Fretting wear under partial slip: section 3 of the paper, without units.

A rigid parabolic indenter f_0 = r^2/(2R) is pressed by a constant normal force and loaded by an oscillating tangential
force. Outside the stick radius c it wears until it touches without pressure: the steady state. Radii are in units of
the initial contact radius a_0, heights in a_0^2/R, and phi = F_x/(mu F_N) is the relative amplitude of the force.

Notation: s = (1+k)/2, q = (1-k)/2, y = (r/c)^2 - 1, sigma = sin(pi s)/pi, Q(y; s) the arcsine tail; Lambda = m/s with
m = phi/((1-phi)(1+s)) is (2/c^2) times the depth by which the punch of radius c goes deeper than its own parabola.
"""

from .deepest import deepest_wear
from .ring import worn_radius
from .stick import stick_radius
from .stresses import edge_intensity, edge_pressure, initial_pressure, steady_pressure, steady_traction
from .surface import initial_displacement, penetration, profile, steady_displacement, wear_depth
from .volume import wear_volume

__all__ = [
    "deepest_wear",
    "edge_intensity",
    "edge_pressure",
    "initial_displacement",
    "initial_pressure",
    "penetration",
    "profile",
    "steady_displacement",
    "steady_pressure",
    "steady_traction",
    "stick_radius",
    "wear_depth",
    "wear_volume",
    "worn_radius",
]
