"""The marks of tests: those that the default run leaves out, and cases."""

import pytest

compiled, long, parametrize = pytest.mark.compiled, pytest.mark.long, pytest.mark.parametrize


def compiled_case(*values, **how):
    """A case that the default run leaves out."""
    return pytest.param(*values, marks=compiled, **how)


def long_case(*values, **how):
    """A case that only the long run has."""
    return pytest.param(*values, marks=long, **how)
