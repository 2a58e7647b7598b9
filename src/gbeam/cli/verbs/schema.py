"""``gbeam schema``: what may be written in a scenario, for editors and for those who look it up."""

from __future__ import annotations

from typing import Annotated

from gbeam.cli.options import Json, option


def schema(
    *,
    json: Json = False,
    markdown: Annotated[bool, option("--markdown", "The keys as a page to read instead.")] = False,
) -> int:
    """Print the JSON schema of scenario files, for editors; or every key, with unit, default and meaning.

    Parameters
    ----------
    json
        As every verb takes it: the schema is one JSON object anyway.
    """
    from gbeam.scenario import json_schema

    if markdown and not json:
        from gbeam.scenario.reference import reference

        print(reference(), end="")
        return 0
    print(json_schema())
    return 0
