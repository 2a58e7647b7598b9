"""Named columns of foreign files that libraries read, in a process of their own: one reader per kind of file."""
