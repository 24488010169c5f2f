"""The wear of a contact over cycles, on the way to its steady state."""
