"""Files with bits, sizes or ends that are not theirs: damage that text does not meet."""

from __future__ import annotations

from fuzz.cases import Random
from fuzz.scenarios import corrupted

_SIZES = (0, 1, 7, 2**15, 2**16 - 1, 2**31 - 1, 2**31, 2**32 - 1, 2**40, 2**63 - 1, 2**64 - 1)


def damaged(chosen: Random, data: bytes) -> bytes:
    """The bytes with bits flipped, a number in them replaced, a stretch emptied or shuffled, or their end cut off."""
    if not data:
        return data
    # What says how large and of which kind the rest is stands at the front of most formats.
    reach = len(data) if chosen.random() < 0.5 else min(len(data), 1024)
    first = chosen.randrange(reach)
    changed = bytearray(data)
    match chosen.randrange(6):
        case 0:
            for _ in range(chosen.choice((1, 1, 4, 32))):
                changed[chosen.randrange(reach)] ^= 1 << chosen.randrange(8)
        case 1:
            return data[:first]
        case 2:
            width, order = chosen.choice((1, 2, 4, 4, 8, 8)), chosen.choice(("little", "big"))
            first -= first % width
            size = chosen.choice(_SIZES) % 2 ** (8 * width)
            changed[first : first + width] = size.to_bytes(width, order)
        case 3:
            last = min(len(data), first + chosen.choice((4, 16, 512)))
            changed[first:last] = chosen.choice((b"\x00", b"\xff")) * (last - first)
        case 4:
            last, other = min(len(data), first + chosen.choice((8, 64, 512))), chosen.randrange(len(data))
            changed[first:last] = data[other : other + last - first]
        case _:
            return corrupted(chosen, data)
    return bytes(changed)
