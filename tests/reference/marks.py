"""The marks of tests that the default run leaves out."""

import pytest

compiled, long = pytest.mark.compiled, pytest.mark.long
