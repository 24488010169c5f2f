"""The border of the library: what arguments may be, how formulas become public functions, and what all rooms share."""
