"""Printed values beside gbeam's answers: both papers number by number, and cases of the literature."""
