"""The documentation site: `make docs`. Nothing in it comes from a network."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import mathjax
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.errors import SphinxError

import gbeam

project = "gbeam"
author = "The gbeam developers"
project_copyright = "the gbeam developers, MIT licence"
version = release = gbeam.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.mathjax", "numpydoc"]
nitpicky = True
smartquotes = False  # a prime is a derivative
exclude_patterns = ["_build"]

myst_enable_extensions = ["dollarmath", "colon_fence", "deflist"]
myst_heading_anchors = 4  # links to headings, as GitHub has them

autodoc_typehints = "none"  # docstrings have types with shapes and units
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True, "class-doc-from": "class"}
numpydoc_show_class_members = False
toc_object_entries_show_parents = "hide"
python_use_unqualified_type_names = True

html_theme = "pydata_sphinx_theme"
html_title = f"gbeam {release}"
# MathJax is one file, of a package that holds nothing else: it needs no Django.
html_static_path = [
    "_static",
    f"{Path(mathjax.__file__).parent}/static/mathjax/es5/tex-svg.js",
]
html_css_files = ["gbeam.css"]
html_copy_source = False
html_show_sphinx = False
html_sidebars = {
    page: [] for page in ("index", "theory", "validation", "changes")
}  # they have no neighbours
mathjax_path = "tex-svg.js"
mathjax3_config = {
    "options": {"enableMenu": False}
}  # the menu loads files that are not there
html_theme_options = {
    "logo": {"text": "gbeam"},
    "navbar_align": "left",
    "show_toc_level": 2,
    "header_links_before_dropdown": 6,
    "footer_start": ["copyright"],
    "footer_end": [],
    "secondary_sidebar_items": ["page-toc"],
}


INDEXED = re.compile(
    r"(?<=[A-Za-zΑ-ώ\u0307\u0308₀-₉])_(ww|al|ab|ij|[A-Za-zΑ-ώ0-9])(?![A-Za-z0-9_])"
)


def leave_formulas(app: Sphinx, doctree: nodes.document) -> None:
    """Give a formula to MathJax as it is: Sphinx would take its number from it."""
    for node in doctree.findall(nodes.math_block):
        text = node.astext()
        node["no-wrap"] = True
        node.children = [nodes.Text(rf"\[{text}\]")]


def lower_indices(app: Sphinx, doctree: nodes.document) -> None:
    """Set the index of a symbol in running text, r_A or ω_y, below the line."""
    for text in list(doctree.findall(nodes.Text)):
        if isinstance(text.parent, nodes.paragraph) and INDEXED.search(text):
            parts: list[nodes.Node] = []
            for i, part in enumerate(INDEXED.split(text)):
                if part:
                    parts.append(
                        nodes.subscript("", part) if i % 2 else nodes.Text(part)
                    )
            text.parent.replace(text, parts)


def escape_bars(
    app: Sphinx, what: str, name: str, value: Any, options: Any, lines: list[str]
) -> None:
    """In docstrings |x| is a size; in reStructuredText it is a substitution."""
    lines[:] = [re.sub(r"(?<!\\)\|", r"\\|", line) for line in lines]


def records_only(
    app: Sphinx, what: str, name: str, value: Any, skip: bool, options: Any
) -> bool:
    """Describe the records of the modules of results, and not their helpers."""
    return skip or (what == "module" and not isinstance(value, type))


def refuse_network(app: Sphinx, exception: Exception | None) -> None:
    """A page that loads anything from a network is an error; plain links are not."""
    if exception is not None:
        return
    for page in Path(app.outdir).rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        loaded = re.findall(
            r"<(?:script|img|iframe|source)[^>]*\bsrc=\"((?:https?:)?//[^\"]*)", text
        )
        loaded += re.findall(r"<link[^>]*\bhref=\"((?:https?:)?//[^\"]*)", text)
        if loaded:
            raise SphinxError(
                f"{page.name} loads {loaded[0]}, and has to be readable offline"
            )


def setup(app: Sphinx) -> None:
    """Register what happens to formulas and docstrings, and what is checked."""
    app.connect("doctree-read", leave_formulas)
    app.connect("doctree-read", lower_indices)
    app.connect("autodoc-process-docstring", escape_bars, priority=900)
    app.connect("autodoc-skip-member", records_only)
    app.connect("build-finished", refuse_network)
