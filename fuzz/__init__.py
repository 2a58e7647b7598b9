"""Malformed input by the thousand: scenarios, records and command lines, each in a process of its own with limits.

``python -m fuzz`` runs 10,000 of them: exit status 2 with a placed message, or 0 or 1 where what was changed is still
valid; no traceback, no defect, ten seconds and 2 GiB at most, no output that looks complete. ``python -m fuzz.faults``
interrupts runs at twenty times, kills them, and fills the disk at every write.
"""
