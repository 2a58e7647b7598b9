"""HDF5 and netCDF, MATLAB and universal files as tables, read in a process of their own: vectors are columns."""

from __future__ import annotations

import math
import os
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gbeam.errors import InputError
from gbeam.guards.hdf5_files import open_hdf5
from gbeam.guards.limits import ELEMENTS, refuse_more
from gbeam.guards.processes import read_cached
from gbeam.io.table import Column, Stated, Table, array_columns, states_rate

if TYPE_CHECKING:
    import h5py

_NETCDF_3 = b"CDF"  # which is not HDF5


def read_hdf5(path: str | os.PathLike[str], words: Sequence[str] = ()) -> Table:
    """Read an HDF5 or netCDF file.

    A vector is a column by its path, ``group/az``, or the path's last word, as is a field of a compound, ``imu/az``; a
    matrix is one column per vector, ``acc[:,0]``. The attribute `units` is the unit. `scale_factor`, `add_offset` and
    `_FillValue` are applied.
    """
    with _naming_problem(path, "cannot be read", "give an HDF5 or netCDF file"):
        with open(path, "rb") as file:
            netcdf_3 = file.read(3) == _NETCDF_3
        return Table(tuple(_netcdf_3(path))) if netcdf_3 else hdf5_table(path)


@contextmanager
def _naming_problem(path: str | os.PathLike[str], problem: str, fix: str) -> Iterator[None]:
    """Turn any exception of a damaged file's library into an InputError with this problem and fix."""
    try:
        yield
    except (InputError, MemoryError):
        raise
    except Exception as error:
        raise InputError("record.file", f"{path} {problem} ({error})", fix) from None


def hdf5_table(path: str | os.PathLike[str], *, matlab: bool = False) -> Table:
    """Columns of an HDF5 file, and the sample rates that it states. MATLAB's hold every matrix transposed."""
    import h5py  # 0.2 s to import

    columns, stated = list[Column](), list[Stated]()
    separator = "." if matlab else "/"

    def add(path_inside: str, item: h5py.Dataset | h5py.Group) -> None:
        for name in filter(states_rate, item.attrs):
            place = f"{path_inside}/{name}".lstrip("/").replace("/", separator)
            stated.extend(_stated(place, item.attrs[name], separator))
        if isinstance(item, h5py.Dataset) and item.size == 1 and item.dtype.kind in "iuf":
            stated.extend(_stated(path_inside.replace("/", separator), item[()], separator))
        if not isinstance(item, h5py.Dataset) or item.shape is None or path_inside.startswith("#"):
            return
        name = path_inside.replace("/", ".") if matlab else path_inside
        if "MATLAB_empty" in item.attrs:  # it holds its sizes
            return
        if matlab and _text(item.attrs.get("MATLAB_class", "double")) not in _NUMBERS:
            columns.append(_object(name, _text(item.attrs["MATLAB_class"])))
            return
        units = np.ravel(item.attrs.get("units", ""))
        fields = [*_fields(item.dtype)]
        for k, (fields_path, shape) in enumerate(fields):
            unit = ""
            if len(units) in (1, len(fields)):
                unit = _text(units[k if len(units) == len(fields) else 0])
            full_shape = item.shape[::-1] if matlab else item.shape + shape
            read = partial(values, path_inside, fields_path)
            columns.extend(array_columns("/".join([name, *fields_path]), full_shape, read, unit=unit, matlab=matlab))

    def values(path_inside: str, fields_path: Sequence[str]) -> NDArray[Any]:
        with h5py.File(path) as file:  # which was looked through
            item = file[path_inside]
            refuse_more("", "numbers", item.size, ELEMENTS, 40.0, "save fewer at a time")
            _refuse_unwritten(item)
            array = item[fields_path[0]] if fields_path else np.asarray(item)
            for field in fields_path[1:]:
                array = array[field]
            array = _unpacked(array, {} if fields_path else item.attrs)
        return array.T if matlab else array

    with open_hdf5(path) as file:
        add("", file)
        file.visititems(add)
    return Table(tuple(columns), stated=tuple(stated))


def _stated(path: str, value: Any, separator: str) -> Iterator[Stated]:
    """Yield the sample rate that a value of a file is by its name."""
    number = np.asarray(value)
    if number.size == 1 and number.dtype.kind in "iuf":
        yield from Stated.read(path, float(number.item()), separator)


def _fields(kind: np.dtype[Any], path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], tuple[int, ...]]]:
    """Yield path and shape of the numbers in one element of a type: of itself, or of the fields of a compound."""
    base, shape = kind.base, kind.shape
    if base.kind in "iuf":
        yield path, shape
    for name in base.names or () if not shape else ():
        yield from _fields(base[name], (*path, name))


def _object(name: str, kind: str) -> Column:
    """Column that only MATLAB can read. It says so when its samples are asked for."""

    def read() -> NDArray[Any]:
        fix = "save numbers beside it, such as s = seconds(t - t(1)) of a datetime t, or z = T.z of a table T"
        raise InputError("", f"is of MATLAB's class {kind}, which only MATLAB reads", fix)

    return Column(name, read)


def _refuse_unwritten(item: h5py.Dataset) -> None:
    """Refuse an array that was written in part only, as by a recorder that stopped: HDF5 reads zeros for the rest."""
    if item.is_virtual or item.external or not item.size:
        return
    parts = math.prod(-(-size // chunk) for size, chunk in zip(item.shape, item.chunks or item.shape, strict=True))
    count = int(item.id.get_storage_size() > 0) if item.chunks is None else item.id.get_num_chunks()
    if count < parts:
        problem = f"has room for {item.size} numbers, of which {count} of {parts} parts were written"
        raise InputError("", problem, "cut it to what was recorded, and save it again")


def _netcdf_3(path: str | os.PathLike[str]) -> list[Column]:
    """Columns of a netCDF file of version 3."""
    from scipy.io import netcdf_file  # 0.4 s to import

    columns: list[Column] = []
    with netcdf_file(path, mmap=False) as file:
        for name, variable in file.variables.items():
            if variable.data.dtype.kind in "iuf":
                attributes = {name: getattr(variable, name) for name in _ATTRIBUTES if hasattr(variable, name)}
                array = _unpacked(np.array(variable.data, dtype=np.float64), attributes)
                unit = _text(attributes.get("units", ""))
                columns += array_columns(name, array.shape, lambda array=array: array, unit=unit)  # type: ignore[misc]
    return columns


def _unpacked(array: NDArray[Any], attributes: Mapping[str, Any]) -> NDArray[np.float64]:
    """Undo the packing of the CF conventions. Missing samples are NaN."""
    fill_values = [np.ravel(attributes[name])[0] for name in ("_FillValue", "missing_value") if name in attributes]
    missing_samples = np.isin(array, fill_values) if fill_values else False
    scale, offset = (np.ravel(attributes.get(name, default))[0] for name, default in _PACKING.items())
    with np.errstate(all="ignore"):  # what is no number is refused where its sample is used
        values = array.astype(np.float64) * np.float64(scale) + np.float64(offset)
    return np.where(missing_samples, np.nan, values) if fill_values else values


_PACKING = {"scale_factor": 1.0, "add_offset": 0.0}
_ATTRIBUTES = "units", "_FillValue", "missing_value", *_PACKING


def _text(attribute: Any) -> str:
    value = np.ravel(attribute)[0] if np.size(attribute) else ""
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    return str(value) if isinstance(value, str) else ""


_STRUCTURES = ("struct", "object")
_OPAQUE = ("s0", "s1", "s2", "arr")  # fields by which SciPy shows an object: name, system, class, contents
_NUMBERS = ("double", "single", "logical", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)))


def read_mat(path: str | os.PathLike[str], words: Sequence[str] = ()) -> Table:
    """Read a MAT file of any version; 7.3 is HDF5.

    A vector is a column by its name, ``az``, or a structure's field by its path, ``rec.az``, or the path's last word; a
    matrix is one column per vector, ``acc(:,1)``.
    """
    with _naming_problem(path, "is not a MAT file", "save the record by MATLAB"), warnings.catch_warnings():
        warnings.filterwarnings("error", ".*may be corrupt")  # numbers of a VAX or a Cray, which SciPy misreads
        warnings.filterwarnings("ignore", "Duplicate variable name")  # of objects, which SciPy calls None
        table = _any_version(path, words)
    if not table.columns:
        fix = "save vectors of numbers; a table T as s = table2struct(T, 'ToScalar', true)"
        raise InputError("record.file", f"{path} holds no numeric variables", fix)
    return table


def _any_version(path: str | os.PathLike[str], words: Sequence[str]) -> Table:
    """Columns of a MAT file: its vectors and matrices, and fields of the structures that `words` may name.

    Other structures are read only if a word is not found yet: it may be the last part of a field's path.
    """
    import scipy.io  # 0.2 s to import

    try:
        variables = scipy.io.whosmat(path)
    except NotImplementedError:  # scipy's word for version 7.3
        return hdf5_table(path, matlab=True)
    except TypeError:  # of a variable that has no shape, such as a datetime
        loaded = {k: v for k, v in scipy.io.loadmat(path, simplify_cells=True).items() if k[:2] != "__"}
        columns = [column for name, value in loaded.items() for column in _columns(name, value)]
        return Table(tuple(columns), stated=tuple(_numbers_stated(loaded)))
    columns = list[Column]()
    numbers: dict[str, Any] = {}
    for name, shape, kind in variables:
        if kind in _NUMBERS:
            if math.prod(shape) == 1:
                numbers[name] = _loaded(path, name)
            squeezed = tuple(size for size in shape if size != 1)
            columns += array_columns(name, squeezed, partial(_array, path, name, shape), matlab=True)
    structures = [name for name, _, kind in variables if kind in _STRUCTURES]
    unfound = {word.removeprefix("-").strip() for word in words} - {column.name for column in columns} - {"0"}
    named_structures = [name for name in structures if any(word.startswith(f"{name}.") for word in unfound)]
    read_structures = {name: _loaded(path, name) for name in named_structures}
    columns += [column for name, value in read_structures.items() for column in _columns(name, value)]
    if not words or unfound - {column.name for column in columns}:  # a part's last word, or a mistake
        unnamed = {name: _loaded(path, name) for name in structures if name not in named_structures}
        columns += [column for name, value in unnamed.items() for column in _columns(name, value)]
        read_structures |= unnamed
    return Table(tuple(columns), stated=tuple(_numbers_stated(numbers | read_structures)))


def _numbers_stated(values: Mapping[str, Any], prefix: str = "") -> Iterator[Stated]:
    """Yield the sample rates among values by name, and among the fields of structures."""
    for name, value in values.items():
        if isinstance(value, dict):
            yield from _numbers_stated(value, f"{prefix}{name}.")
        elif np.ndim(value) == 0:
            yield from _stated(f"{prefix}{name}", value, ".")


def _loaded(path: str | os.PathLike[str], name: str) -> Any:
    import scipy.io

    return scipy.io.loadmat(path, simplify_cells=True, variable_names=[name])[name]


def _array(path: str | os.PathLike[str], name: str, shape: tuple[int, ...]) -> NDArray[Any]:
    """Values of a variable of a MAT file; InputError if they are too many or complex."""
    refuse_more("", "numbers", math.prod(shape), ELEMENTS, 8.0, "save fewer at a time")
    values: NDArray[Any] = _loaded(path, name)
    if values.dtype.kind not in "iuf":
        raise InputError("", "holds complex numbers", "save their real parts")
    return values


def _columns(name: str, value: Any) -> list[Column]:
    """Columns of a value of a MAT file, or of all fields of a structure; none if it is no array of real numbers."""
    if isinstance(value, dict):
        return [column for field, part in value.items() for column in _columns(f"{name}.{field}", part)]
    if isinstance(value, np.ndarray) and value.dtype.names == _OPAQUE:
        name, _, kind, _ = value[0]
        return [_object(_text(name), _text(kind))]
    if not isinstance(value, np.ndarray) or value.dtype.kind not in "iuf":
        return []
    return array_columns(name, value.shape, lambda: value, matlab=True)


_TIME = "time"
_RESPONSES = (0, 1)  # function types: general, time response
_DIRECTIONS = ("", "X", "Y", "Z", "RX", "RY", "RZ")
_NO_NAME = ("", "NONE")
_A_LINE = 6  # values at most


def read_uff(path: str | os.PathLike[str], words: Sequence[str] = ()) -> Table:
    """Read the time responses (data set 58, text or binary) of a universal file.

    A column goes by the first line of the data set's identification, and by its node and direction, ``12+Z``. The
    abscissa is the column ``time``.
    """
    import pyuff  # 0.2 s to import

    with _naming_problem(path, "is not a universal file", "export it as UFF 58"):
        file = pyuff.UFF(os.fspath(path))
        sets = [file.read_sets(i) for i, kind in enumerate(file.get_set_types()) if int(kind) == 58]
    sets = [data_set for data_set in sets if data_set["func_type"] in _RESPONSES and np.isrealobj(data_set["data"])]
    if not sets:
        raise InputError("record.file", f"{path} holds no time response", "export data sets of type 58")
    time = _samples(sets[0], "x")
    names = Counter(_name(data_set) for data_set in sets)
    columns = [Column(_TIME, lambda: time, _unit(sets[0]["abscissa_axis_units_lab"]))]
    for data_set in sets:
        point = _point(data_set)
        name = _name(data_set) if names[_name(data_set)] == 1 else point
        abscissa = _samples(data_set, "x")
        if abscissa.shape != time.shape or not np.allclose(abscissa, time, rtol=0, atol=1e-6 * np.ptp(time)):
            raise InputError(
                "record.file", f"{path} has responses at different times, such as {name!r}", "export them at one rate"
            )
        values = _samples(data_set, "data")
        unit = _unit(data_set["ordinate_axis_units_lab"])
        columns.append(Column(name, lambda values=values: values, unit, (point,)))  # type: ignore[misc]
    steps = {float(data_set["abscissa_inc"] or 0) for data_set in sets if data_set["abscissa_spacing"] == 1}
    return Table(tuple(columns), stated=tuple(rate for step in steps for rate in Stated.read("dt", step, "/")))


def _samples(data_set: dict[str, Any], key: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Abscissae or values; InputError unless they are as many as stated, but for what fills the last line."""
    values, stated = np.asarray(data_set[key], dtype=np.float64), int(data_set["num_pts"])
    if not 0 <= len(values) - stated < _A_LINE:
        problem = f"states {stated} samples of {_name(data_set)!r} and holds {len(values)}"
        raise InputError("record.file", problem, "export it again: the rest, or the header, is of another record")
    return values[:stated]


def _name(data_set: dict[str, Any]) -> str:
    name = data_set["id1"].strip()
    return _point(data_set) if name.upper() in _NO_NAME else name


def _point(data_set: dict[str, Any]) -> str:
    direction = int(data_set["rsp_dir"])
    return f"{int(data_set['rsp_node'])}{'-' if direction < 0 else '+'}{_DIRECTIONS[abs(direction)]}"


def _unit(label: str) -> str:
    label = label.strip()
    return "" if label.upper() in _NO_NAME else label


READERS: dict[str, Callable[[str, Sequence[str]], Table]] = {
    ".mat": read_mat,
    **dict.fromkeys((".h5", ".hdf5", ".hdf", ".he5", ".nc", ".nc4", ".cdf"), read_hdf5),
    **dict.fromkeys((".uff", ".unv", ".ufb", ".uf"), read_uff),
}


def is_binary(path: str | os.PathLike[str]) -> bool:
    """True if a library reads the file, by the end of its name. Everything else is text."""
    return Path(path).suffix.lower() in READERS


def read_binary(path: str | os.PathLike[str], words: Iterable[str] = ()) -> Table:
    """Read the names and units of all columns, and the samples of those that `words` name."""

    def refuse(problem: str) -> InputError:
        return InputError("record.file", f"{path} {problem}", "export the record again, with fewer variables")

    parts = read_cached(parts_of, path, tuple(sorted(set(words))), refuse=refuse)
    columns = tuple(_column(**column) for column in parts["columns"])
    return Table(columns, stated=tuple(Stated(*entry) for entry in parts["stated"]))


def _column(name: str, unit: str, aliases: Sequence[str], samples: Any = None, refusal: Sequence[str] = ()) -> Column:
    """Column that was read in another process: it has its samples, or a refusal that is raised when
    they are asked for.
    """

    def read() -> Any:
        if refusal:
            raise InputError("", *refusal)
        return samples

    return Column(name, read, unit, tuple(aliases))


def parts_of(path: str, words: list[str]) -> dict[str, Any]:
    """Return names, units and aliases of the columns of a file, and the sample rates that it states.

    Columns that `words` name also have their samples.
    """
    table = READERS[Path(path).suffix.lower()](path, words)
    needed_columns = set()
    for word in words:
        with suppress(InputError):  # no column, or several: refused where it is looked for
            needed_columns.add(table.column("", table.signed(word)[1] or ""))
    columns = []
    for column in table.columns:
        samples = _sampled(column) if column in needed_columns else {}
        columns.append({"name": column.name, "unit": column.unit, "aliases": column.aliases} | samples)
    return {"columns": columns, "stated": [[rate.name, rate.rate, rate.of] for rate in table.stated]}


def _sampled(column: Column) -> dict[str, Any]:
    """Samples of a column, or the problem and the fix if they cannot be read."""
    try:
        return {"samples": np.asarray(column.read(), dtype=np.float64)}
    except MemoryError:
        raise
    except InputError as error:
        return {"refusal": [error.problem, error.fix]}
    except Exception as error:  # a damaged file leads its library to any
        return {"refusal": [f"cannot be read ({error})", "export the record again"]}
