"""The load a centrifuge is to make: a flight's, within idle and the gimbals' reach, its corners rounded."""
