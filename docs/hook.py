"""What the site needs besides mkdocs: formulas as MathML, links to the equations, the pages beside the documentation.

Formulas become MathML when the site is built, and the browser draws it: pages need no script and no other host.
`math_core` writes the subset that all browsers share; the OpenType font that stretches braces and roots comes with
`ziamath`. Equation numbers in pages and docstrings, such as Eq. (12), become links to the theory page.
"""

import html
import importlib.resources
import re
import sys
from pathlib import Path

from math_core import LatexToMathML
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError
from mkdocs.plugins import event_priority
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

BESIDE = {
    "contributing.md": "CONTRIBUTING.md",
    "changelog.md": "CHANGELOG.md",
}  # pages that lie beside the documentation
# what a search of the site should find before the functions of Python and the notebooks, besides the other parts
FOUND_FIRST = {
    f"reference/{page}.md" for page in ("glossary", "input_file", "parameters", "quantities", "troubleshooting")
}
FONT = "STIXTwoMath-Regular.ttf"

FORMULA = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.DOTALL)
APART = re.compile(r"(<(?:pre|code|script|style|svg|button)\b.*?</(?:pre|code|script|style|svg|button)>)", re.DOTALL)
DISPLAYED = re.compile(r"\$\$(.+?)\$\$", re.DOTALL)
INLINE = re.compile(r"\$([^$]+?)\$")
NUMBER = re.compile(r"\\tag\{(\d+)\}")

THEORY = "explanation/theory.md"
PIECE = re.compile(r"<(a|h\d|pre|code|math|script|style|svg|button)\b.*?</\1>|<[^>]*>|[^<]+", re.DOTALL)
BRACKETED = r"\(\d+\)"
SERIES = rf"{BRACKETED}(?:(?:\s*(?:,|and|or|to|-|–|, and)\s*){BRACKETED})*"
CITED = re.compile(rf"\bEqs?\.(?:\s|&nbsp;)*{SERIES}")
ONLY_NUMBERS = re.compile(rf"\s*{SERIES}\s*")  # a cell of a table

sys.path.insert(0, str(Path(__file__).parent))
import generated  # noqa: E402

convert = LatexToMathML().convert_with_local_state


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Give the notebooks, which lie beside the documentation, their place."""
    names = [path.name for path in notebooks(config)]
    if names and config.nav is not None:
        places = [index for index, entry in enumerate(config.nav) if "Reference" in entry]
        config.nav.insert(places[0], {"Notebooks": [f"notebooks/{name}" for name in names]})
    return config


def notebooks(config: MkDocsConfig) -> list[Path]:
    """All of them."""
    return sorted((Path(config.config_file_path).parent / "notebooks").glob("*.ipynb"))


@event_priority(100)  # before mkdocs-jupyter looks for them
def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add what is made while building."""
    font = importlib.resources.files("ziamath").joinpath("fonts", FONT).read_bytes()
    files.append(File.generated(config, f"assets/{FONT}", content=font))
    for page, source in BESIDE.items():
        text = (Path(config.config_file_path).parent / source).read_text(encoding="utf-8")
        files.append(File.generated(config, page, content=text.replace("](docs/", "](")))
    for path in notebooks(config):
        root = str(path.parent.parent)
        files.append(File(f"notebooks/{path.name}", root, config.site_dir, config.use_directory_urls))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Leave out where numbers come from, and say how well a search should find the page."""
    if not page.file.src_uri.startswith(("reference/", "notebooks/")) or page.file.src_uri in FOUND_FIRST:
        page.meta["search"] = {"boost": 2}
    return generated.QUOTED.sub(r"\g<shown>", generated.quoted(markdown))


def on_page_content(content: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Make MathML of the formulas."""

    def mathml(match: re.Match[str]) -> str:
        latex = html.unescape(match[2]).strip()
        number = NUMBER.search(latex)
        try:
            math = convert(NUMBER.sub("", latex), displaystyle=match[1] == "div")
        except Exception as error:
            raise PluginError(f"{page.file.src_uri}: {latex}: {error}") from error
        if match[1] == "span":
            return math
        if number is None:
            return f'<div class="equation">{math}</div>'
        place = f"eq-{number[1]}"
        return f'<div class="equation" id="{place}">{math}<a href="#{place}">({number[1]})</a></div>'

    if page.file.src_uri.endswith(".ipynb"):
        content = _of_notebook(content)
    return _linked(FORMULA.sub(mathml, content), page, config, files)


def _linked(content: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Make links of the equation numbers: after "Eq.", alone in a cell, and anywhere in the text of the theory page."""
    theory = files.get_file_from_path(THEORY)
    if theory is None:
        raise PluginError(f"{THEORY}: missing; equation numbers link to it")
    numbers = set(NUMBER.findall((Path(config.docs_dir) / THEORY).read_text(encoding="utf-8")))
    own = page.file.src_uri == THEORY
    target = "" if own else theory.url_relative_to(page.file)

    def link(match: re.Match[str]) -> str:
        number = match[0][1:-1]
        if number not in numbers:
            raise PluginError(f"{page.file.src_uri}: {THEORY} has no equation {match[0]}")
        return f'<a href="{target}#eq-{number}">{match[0]}</a>'

    def links(match: re.Match[str]) -> str:
        return re.sub(BRACKETED, link, match[0])

    def linked(piece: re.Match[str]) -> str:
        text = piece[0]
        if text.startswith("<"):  # a tag, or an element whose text stays as it is
            return text
        return links(piece) if own or ONLY_NUMBERS.fullmatch(text) else CITED.sub(links, text)

    return PIECE.sub(linked, content)


def _of_notebook(content: str) -> str:
    """The formulas of a notebook's text, marked as those of the pages are; its code and pictures left alone."""
    parts = APART.split(content)
    for index in range(0, len(parts), 2):
        parts[index] = DISPLAYED.sub(r'<div class="arithmatex">\[\1\]</div>', parts[index])
        parts[index] = INLINE.sub(r'<span class="arithmatex">\(\1\)</span>', parts[index])
    return "".join(parts)
