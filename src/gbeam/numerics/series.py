"""Taylor series in time, and derivatives by complex steps."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import reduce
from math import factorial
from operator import add
from typing import Any, ClassVar

import numpy as np

from gbeam.arrays.namespace import as_array, namespace
from gbeam.arrays.tree import record


@record
class Series:
    """Coefficients f, f', f''/2, ... : arrays of one shape, that of time with trailing axes for vectors."""

    __array_ufunc__: ClassVar[None] = None  # NumPy's arrays leave arithmetic with a series to it
    coefficients: tuple[Any, ...]

    @classmethod
    def variable(cls, t: Any, order: int) -> Series:
        """Time itself at times `t` (s)."""
        time = as_array(t)
        xp = namespace(time)
        return cls.from_derivatives([time, xp.ones_like(time)], order)

    @classmethod
    def from_derivatives(cls, derivatives: Sequence[Any], order: int) -> Series:
        """Series of an order by the value and derivatives f, f', f'', …; those that are left out are zero."""
        coefficients = [value / factorial(k) if k > 1 else value for k, value in enumerate(derivatives[: order + 1])]
        if len(coefficients) <= order:
            coefficients += [namespace(*derivatives).zeros_like(derivatives[0])] * (order + 1 - len(coefficients))
        return cls(tuple(coefficients))

    @classmethod
    def in_pieces(cls, function: Callable[[Any], Series], t: Any, count: int) -> Series:
        """A function's series at times `t` (n,), s, computed in `count` pieces one after the other to save memory."""
        pieces = [function(piece).coefficients for piece in np.array_split(t, count)]
        return cls(tuple(np.concatenate(parts) for parts in zip(*pieces, strict=True)))

    @property
    def order(self) -> int:
        """Order of the highest derivative."""
        return len(self.coefficients) - 1

    @property
    def value(self) -> Any:
        """The function itself."""
        return self.coefficients[0]

    def derivatives(self) -> tuple[Any, ...]:
        """The function and its derivatives, up to the order."""
        return tuple(c * factorial(k) if k > 1 else c for k, c in enumerate(self.coefficients))

    def rate(self) -> Series:
        """The derivative, of one order less."""
        return Series(tuple(k * c if k > 1 else c for k, c in enumerate(self.coefficients) if k > 0))

    def truncated(self, order: int) -> Series:
        """Series up to a lower order."""
        return Series(self.coefficients[: order + 1])

    def map(self, function: Callable[[Any], Any]) -> Series:
        """Apply a linear function, the same at all times, to each coefficient."""
        return Series(tuple(function(c) for c in self.coefficients))

    def __getitem__(self, index: Any) -> Series:
        return self.map(lambda c: c[index])

    def __neg__(self) -> Series:
        return self.map(lambda c: -c)

    def __add__(self, other: Any) -> Series:
        if isinstance(other, Series):
            return Series(tuple(a + b for a, b in zip(self.coefficients, other.coefficients, strict=False)))
        return Series((self.value + other, *self.coefficients[1:]))

    __radd__ = __add__

    def __sub__(self, other: Any) -> Series:
        return self + -other

    def __rsub__(self, other: Any) -> Series:
        return -self + other

    def __mul__(self, other: Any) -> Series:
        if not isinstance(other, Series):
            return self.map(lambda c: c * other)
        a, b = self.coefficients, other.coefficients
        return Series(tuple(_total(a[j] * b[k - j] for j in range(k + 1)) for k in range(min(len(a), len(b)))))

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Series:
        if not isinstance(other, Series):
            return self.map(lambda c: c / other)
        a, b, quotient = self.coefficients, other.coefficients, list[Any]()
        for k in range(min(len(a), len(b))):
            quotient.append((a[k] - sum(b[j] * quotient[k - j] for j in range(1, k + 1))) / b[0])
        return Series(tuple(quotient))

    def __pow__(self, exponent: int) -> Series:
        """A whole power, one or more."""
        if exponent == 1:
            return self
        half = self ** (exponent // 2)
        return half * half if exponent % 2 == 0 else half * half * self


def _total(terms: Iterable[Any]) -> Any:
    return reduce(add, terms)


def power(base: Series, exponent: float) -> Series:
    """A real power of a positive series."""
    a = base.coefficients
    result = [a[0] ** exponent]
    for k in range(1, len(a)):
        terms = (((exponent + 1) * j - k) * a[j] * result[k - j] for j in range(1, k + 1))
        result.append(_total(terms) / (k * a[0]))
    return Series(tuple(result))


def sqrt(square: Series) -> Series:
    """Square root of a positive series."""
    a = square.coefficients
    root = [namespace(a[0]).sqrt(a[0])]
    for k in range(1, len(a)):
        root.append((a[k] - sum(root[j] * root[k - j] for j in range(1, k))) / (2 * root[0]))
    return Series(tuple(root))


def sin_cos(angle: Series) -> tuple[Series, Series]:
    """Sine and cosine."""
    a = angle.coefficients
    xp = namespace(a[0])
    sine, cosine = [xp.sin(a[0])], [xp.cos(a[0])]
    for k in range(1, len(a)):
        sine.append(_total(j * a[j] * cosine[k - j] for j in range(1, k + 1)) / k)
        cosine.append(-_total(j * a[j] * sine[k - j] for j in range(1, k + 1)) / k)
    return Series(tuple(sine)), Series(tuple(cosine))


def arctan2(y: Series, x: Series) -> Series:
    """Angle of the point (x, y), which must not be the origin; from −π to π."""
    xp = namespace(y.value, x.value)
    value = xp.arctan2(y.value, x.value)
    if y.order == 0 or x.order == 0:
        return Series((value,))
    rate = (x * y.rate() - y * x.rate()) / (x * x + y * y)
    return Series((value, *(c / (k + 1) for k, c in enumerate(rate.coefficients))))


def where(condition: Any, chosen: Series | Any, other: Series | Any) -> Series:
    """One series where a condition on each time holds, another elsewhere. Either may be a constant."""
    a, b = (s.coefficients if isinstance(s, Series) else None for s in (chosen, other))
    length = min(len(c) for c in (a, b) if c is not None)
    a, b = (c or (s, *[0.0] * length) for c, s in ((a, chosen), (b, other)))
    xp = namespace(condition, a[0], b[0])
    return Series(tuple(xp.where(condition, a[k], b[k]) for k in range(length)))


def stack(parts: Sequence[Series]) -> Series:
    """A vector of its components, along a new last axis."""
    xp = namespace(*(part.value for part in parts))
    orders = zip(*(part.coefficients for part in parts), strict=False)
    return Series(tuple(xp.stack(xp.broadcast_arrays(*coefficients), axis=-1) for coefficients in orders))


def square(vector: Series) -> Series:
    """Squared length of a vector, along its last axis."""
    return (vector * vector).map(lambda c: c.sum(axis=-1))


def compose(derivatives: Sequence[Any], inner: Series) -> Series:
    """Series of a function f(inner), by f and its derivatives by `inner` at the value of this, up to its order."""
    change = Series((0.0 * inner.value, *inner.coefficients[1:]))
    result = Series.from_derivatives([derivatives[inner.order] / factorial(inner.order)], inner.order)
    for k in range(inner.order - 1, -1, -1):
        result = result * change + derivatives[k] / factorial(k)
    return result


STEP = 1e-30
