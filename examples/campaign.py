"""Three manoeuvres of one sortie in one file, as a recorder leaves them: data/campaign.csv, which campaign.toml flies.

`python examples/campaign.py` writes the file again. It is the flight of data/f16_pulls_and_push.csv, at 50 Hz, between
five seconds at rest before and behind, read by sensors that are off and drift: on the ground n_z reads 1.02 g downwards
and later 1.05 g. The column `event` numbers the manoeuvres; it is 0 on the ground and in between.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
HERE = Path(__file__).parent / "data"
NAMES = "n_x_g", "n_y_g", "n_z_g", "p_rad_s", "q_rad_s", "r_rad_s"
RATE, REST, BLEND = 50.0, 5.0, 3.0  # Hz, s: at rest, and from there to flight
EVENTS = {1: (8.0, 18.0), 2: (20.0, 27.5), 3: (28.0, 43.5)}  # s
# Read at the first and at the last time besides what is there; g, rad/s.
OFF = np.array([[0.012, -0.008, -0.02, 0.002, -0.001, 0.0015], [0.02, -0.02, -0.05, 0.004, -0.004, 0.0015]])
NOISE = np.array([0.003, 0.003, 0.003, 0.0005, 0.0005, 0.0005])
AT_REST = np.array([0.0, 0.0, -1.0, 0.0, 0.0, 0.0])  # z down


def campaign() -> tuple[Floats, Floats, NDArray[np.int_]]:
    """Times (t,) s, what the six sensors read (t, 6), and the event (t,)."""
    flight = np.genfromtxt(HERE / "f16_pulls_and_push.csv", delimiter=",", names=True)
    flown = np.stack([flight[name] for name in NAMES], axis=1)
    first, last = REST + BLEND, REST + BLEND + float(flight["time_s"][-1])
    time = np.arange(round((last + BLEND + REST) * RATE) + 1) / RATE
    true = np.stack([np.interp(time - first, flight["time_s"], each) for each in flown.T], axis=1)
    share = np.interp(time, [REST, first, last, last + BLEND], [0.0, 1.0, 1.0, 0.0])[:, None]
    smooth = share**2 * (3 - 2 * share)
    true = AT_REST + smooth * (true - AT_REST)
    off = OFF[0] + (OFF[1] - OFF[0]) * (time / time[-1])[:, None]
    read = true + off + NOISE * np.random.default_rng(57).normal(size=true.shape)
    event = np.zeros(len(time), dtype=int)
    for number, (begin, end) in EVENTS.items():
        event[(time >= begin) & (time <= end)] = number
    return time, read, event


def main() -> None:
    """Write data/campaign.csv."""
    time, read, event = campaign()
    columns = ",".join(["time_s", "event", *NAMES])
    rows = np.column_stack([time, event, read])
    with (HERE / "campaign.csv").open("w", encoding="utf-8", newline="\n") as file:
        np.savetxt(file, rows, fmt=["%.2f", "%d", *["%.4f"] * 6], delimiter=",", header=columns, comments="")


if __name__ == "__main__":
    main()
