"""The steady state of a contact: the paper's closed forms, or a numerical solution."""
