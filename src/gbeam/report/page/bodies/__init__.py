"""The inside of a page, by kinds of result: a run, a machine's plan, one steady state, a placement, many cases."""
