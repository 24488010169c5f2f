"""What the figures of the paper are called, with their width and height in cm. Imports nothing that takes time."""

from .units import text_cells

PAPER_FIGURES = {
    key: about
    for key, *about in text_cells("""
    1        Fig. 1    Gross slip of a flat punch: set-up and pressure             17.8  5.6
    2        Fig. 2    Indenter profile and surface displacement for k = −0.5      8.6   6.6
    3        Fig. 3    Indenter profile and surface displacement for k = 0.5       8.6   6.6
    4        Fig. 4    Effective volume change over the exponent                   8.6   6.0
    5        Fig. 5    Normal force in the initial and steady state                17.8  7.0
    table-1  Table 1   Normal force against the homogeneous half-space             8.6   8.8
    6        Fig. 6    Partial slip of a parabolic indenter, set-up                17.8  5.2
    7        Fig. 7    Inner and outer radius of the worn ring                     8.6   7.0
    eq-27    Eq. (27)  Three materials with the same contact radius                8.6   6.2
    8        Fig. 8    Limiting profiles for three amplitudes and exponents        8.6   14.5
    9        Fig. 9    Wear volume over the amplitude                              17.8  8.4
    10       Fig. 10   Pressures in the fully worn state                           8.6   14.5
""")
}
