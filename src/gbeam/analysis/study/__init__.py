"""A whole scenario: every environment, and every model of it."""
