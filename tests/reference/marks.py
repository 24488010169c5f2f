"""The marks of tests: those that the default run leaves out, and cases."""

from functools import partial

import pytest

compiled, long, parametrize = pytest.mark.compiled, pytest.mark.long, pytest.mark.parametrize
# A case that the default run leaves out, and one that only the long run has.
compiled_case, long_case = (partial(pytest.param, marks=mark) for mark in (compiled, long))
