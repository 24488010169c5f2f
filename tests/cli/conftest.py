"""Each test of a command has a folder of its own."""

import pytest


@pytest.fixture(autouse=True)
def _folder(here):
    pass
