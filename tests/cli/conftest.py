"""Each test of a command has a folder of its own."""

import pytest


@pytest.fixture(autouse=True)
def _folder(here):
    pass


@pytest.fixture
def undrawn(monkeypatch):
    """Pictures are made, but put on empty paper: to draw them takes more time than all else that a command does."""
    monkeypatch.setattr("plgwear_jax.plots.save", lambda figure, path: path.touch())
