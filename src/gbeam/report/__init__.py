"""A study in words: a table for people, one JSON object for programs. Both say the same, from `figures`."""

from gbeam.report.summary import summary
from gbeam.report.summary_json import as_json, summary_json

__all__ = ["as_json", "summary", "summary_json"]
