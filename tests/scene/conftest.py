"""Each test of an input file or a table has a folder of its own."""

import pytest


@pytest.fixture(autouse=True)
def _folder(here):
    pass
