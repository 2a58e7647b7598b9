"""The text of a scenario: units, positions of its entries, overrides, diagnostics."""
