"""Malformed input by the thousand, each in a process of its own with limits.

Scenarios, records, meshes, matrices and laws of every format, command lines of every verb, results, answers and stores
that are damaged, and requests to the app over folders that are.

``python -m fuzz`` runs 10,000 of them: exit status 2 with a placed message, or 0 or 1 where what was changed is still
valid; no traceback, no defect, ten seconds without a word and 2 GiB at most, no output that looks complete.
``python -m fuzz.faults`` interrupts runs at twenty times, kills them, and fills the disk at every write.
"""
