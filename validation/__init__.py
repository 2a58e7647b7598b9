"""Evidence: what gbeam answers beside independent codes and published figures.

    python -m validation [--only NAME]

Each module of MODULES has a TITLE, a docstring that introduces its chapter, the packages and programs it NEEDS, and
`rows()`, which yields one :class:`validation.table.Row` after another. What it found is kept in `results/`, with the
versions that found it; `docs/validation.md` is made from all that is kept.
"""

# In the page's order, below this package.
MODULES: tuple[str, ...] = (
    "codes.kane",
    "codes.kane_trees",
    "codes.hermite",
    "codes.calculix",
    "codes.calculix_solid",
    "codes.calculix_specimens",
    "codes.calculix_shells",
    "codes.calculix_flights",
    "codes.calculix_fillet",
    "codes.calculix_bent",
    "codes.calculix_paths",
    "codes.calculix_links",
    "codes.calculix_supports",
    "codes.calculix_heat",
    "codes.scipy_place",
    "codes.exudyn_plane",
    "codes.exudyn_space",
    "codes.exudyn_trees",
    "codes.exudyn_rods",
    "published.paper2009",
    "published.paper2020",
    "published.references",
    "published.others",
    "published.space_beams",
    "published.closed_forms",
    "accuracy.random_scenarios",
    "accuracy.integrators",
    "accuracy.kinds",
    "accuracy.supports",
)
