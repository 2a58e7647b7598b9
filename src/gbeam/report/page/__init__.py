"""A result as one page of HTML that opens without a network: words, tables, plots that zoom, and the viewer.

`document` puts a page together of what a module for each kind of result says, and of the figures that `parts` shows.
What draws them is `assets`, built from `web/` by `make web`.
"""
