"""Input files of tests, and where those of the repository lie."""

from pathlib import Path

from plgwear_jax import scene

ROOT = Path(__file__).parents[2]
DESIGNS = ROOT / "design"


def changed(text, *replacements):
    """The text with other parts, each of which it has once."""
    for old, new in replacements:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def scene_of(text, folder=Path(), **tables):
    """The scene of an input file, beside which lie tables of these names."""
    for name, content in tables.items():
        (folder / f"{name}.csv").write_text(content, "utf-8")
    file = folder / "scene.toml"
    file.write_text(text, "utf-8")
    return scene.load(file)
