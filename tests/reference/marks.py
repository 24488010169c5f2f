"""The marks of tests: those that the default run leaves out, and cases."""

import pytest

compiled, long, parametrize = pytest.mark.compiled, pytest.mark.long, pytest.mark.parametrize
