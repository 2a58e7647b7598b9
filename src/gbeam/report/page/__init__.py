"""A result as one page of HTML that opens without a network: words, tables, plots that zoom, and the viewer.

`document` puts a page together of what `bodies` say of each kind of result; `parts` are its tables and headings,
`series` and `scene` the numbers that the page draws. What draws them is `assets`, built from `web/` by `make web`.
"""
