"""Files of HDF5 that hold all that is read from them."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import h5py


@contextmanager
def open_hdf5(path: str | os.PathLike[str]) -> Iterator[h5py.File]:
    """Open a file of HDF5; ValueError if a link, or the numbers of a data set, lead into another file."""
    import h5py  # 0.2 s to import

    def refuse_elsewhere(name: str, node: Any) -> None:
        references = list[tuple[str, str]]()
        if isinstance(node, h5py.Group):
            links = [(f"{name}/{key}".lstrip("/"), node.get(key, getlink=True)) for key in node]
            references = [(key, link.filename) for key, link in links if isinstance(link, h5py.ExternalLink)]
        elif isinstance(node, h5py.Dataset):
            references = [(name, part[0]) for part in node.external or ()]
            references += [(name, part.file_name) for part in (node.virtual_sources() if node.is_virtual else ())]
        for key, file_name in references:
            if file_name != ".":  # this one
                raise ValueError(f"{key} lies in another file, {file_name}: copy it into this one")

    with h5py.File(path) as file:
        refuse_elsewhere("", file)
        file.visititems(refuse_elsewhere)
        yield file
