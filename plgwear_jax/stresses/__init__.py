"""Stresses in the half-space under a contact."""
