"""``gbeam schema``: what may be written in a scenario, for editors and for those who look it up."""

from __future__ import annotations

from gbeam.cli.options import Json


def schema(*, json: Json = False) -> int:
    """Print the JSON schema of scenario files, for editors.

    Parameters
    ----------
    json
        As every verb takes it: the schema is one JSON object anyway.
    """
    from gbeam.scenario import json_schema

    print(json_schema())
    return 0
