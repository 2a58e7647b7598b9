"""The documentation site: `make docs`. Nothing in it is fetched from a network, when it is built or when it is read."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.errors import SphinxError
from sphinx.writers.html5 import HTML5Translator

import gbeam

project = "gbeam"
author = "The gbeam developers"
project_copyright = "the gbeam developers, MIT licence"
version = release = gbeam.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "numpydoc"]
nitpicky = True
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
html_static_path = ["_static"]
html_css_files = ["gbeam.css"]
html_copy_source = False
html_show_sphinx = False
html_sidebars = {page: [] for page in ("index", "theory", "validation", "changes")}  # they have no neighbours
html_math_renderer = "mathml"
html_theme_options = {
    "logo": {"text": "gbeam"},
    "navbar_align": "left",
    "show_toc_level": 2,
    "header_links_before_dropdown": 6,
    "footer_start": ["copyright"],
    "footer_end": [],
    "secondary_sidebar_items": ["page-toc"],
}


def inline_math(translator: HTML5Translator, node: nodes.math) -> None:
    """MathML, which browsers draw themselves: there is no script to bundle."""
    translator.body.append(tex2mathml(node.astext()))
    raise nodes.SkipNode


def display_math(translator: HTML5Translator, node: nodes.math_block) -> None:
    """MathML in a block that scrolls by itself where it is wider than the page, with its number beside it."""
    text, _, tag = node.astext().partition(r"\tag")
    number = tag.strip("{} \n")
    translator.body.append('<div class="display-math">' + tex2mathml(text.strip(), as_block=True))
    if number:
        translator.body.append(f'<span class="equation-number">({number})</span>')
    translator.body.append("</div>\n")
    raise nodes.SkipNode


def escape_bars(app: Sphinx, what: str, name: str, value: Any, options: Any, lines: list[str]) -> None:
    """In docstrings |x| is a size; reStructuredText would take it for a substitution."""
    lines[:] = [re.sub(r"(?<!\\)\|", r"\\|", line) for line in lines]


def refuse_network(app: Sphinx, exception: Exception | None) -> None:
    """A page that loads anything from a network is an error; plain links to other places are not."""
    if exception is not None:
        return
    for page in Path(app.outdir).rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        loaded = re.findall(r"<(?:script|img|iframe|source)[^>]*\bsrc=\"((?:https?:)?//[^\"]*)", text)
        loaded += re.findall(r"<link[^>]*\bhref=\"((?:https?:)?//[^\"]*)", text)
        if loaded:
            raise SphinxError(f"{page.name} loads {loaded[0]}: the documentation has to be readable offline")


def setup(app: Sphinx) -> None:
    """Register how formulas are drawn, and what is checked."""
    app.add_html_math_renderer("mathml", inline_renderers=(inline_math, None), block_renderers=(display_math, None))
    app.connect("autodoc-process-docstring", escape_bars, priority=900)
    app.connect("build-finished", refuse_network)
