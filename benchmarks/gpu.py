"""Batches on a GPU, where JAX sees one, beside all cores of the processor: below how many cases the processor wins.

    python benchmarks/gpu.py [--most 16384]

The same slews as batch.py, in wall time, s, of the second of two runs; on the GPU all cases of a run stand in one
program. Every number of cases is computed on both, and the last line says from where on the GPU is the quicker one.
Without a GPU the processor's times are printed, and that nothing was compared.
"""

from __future__ import annotations

import argparse
import time

import jax
import numpy as np

import gbeam as gb
from gbeam.analysis import TOGETHER

SECTION, MATERIAL = gb.Section.general(7.2968e-5, 8.2189e-9, 8.2189e-9), gb.Material(2766.7, 6.8952e10)


def seconds(structure: gb.Structure, count: int, device: jax.Device, together: int) -> float:
    """Wall time of a run of `count` slews on a device, so many in one program; of the second of two runs."""
    with jax.default_device(device):
        for _ in range(2):
            began = time.perf_counter()
            hubs = (gb.Hub(radius=0.5, rate=gb.SmoothStep(3.0 * share, 30.0)) for share in np.linspace(0.8, 1, count))
            cases = ((structure, hub) for hub in hubs)
            how = {"duration": 50.0, "integrator": "newmark", "step": 0.03125, "loads": False}
            done = sum(response.outcome == "done" for _, response in gb.simulate_batch(cases, together=together, **how))
            assert done == count
        return time.perf_counter() - began


def main() -> None:
    """Print times and where the GPU begins to win."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--most", type=int, default=4096, help="cases of the largest run")
    options = parser.parse_args()
    structure = gb.assemble(
        gb.Beam(8.0, SECTION, MATERIAL, damping_ratio=0.0, rotary_inertia=False), "FOAM", axial=5, y=5
    )
    processor = jax.devices("cpu")[0]
    try:
        graphics = jax.devices("gpu")[0]
    except RuntimeError:
        graphics = None
    counts = [64 * 4**k for k in range(8) if 64 * 4**k <= options.most]
    won = None
    for count in counts:
        on_processor = seconds(structure, count, processor, TOGETHER)
        line = f"{count} cases: {count / on_processor:.4g} cases/s on the processor"
        if graphics is not None:
            on_graphics = seconds(structure, count, graphics, count)
            line += f", {count / on_graphics:.4g} on {graphics.device_kind}"
            if on_graphics < on_processor and won is None:
                won = count
        print(line, flush=True)
    if graphics is None:
        print("JAX sees no GPU here: nothing was compared")
    else:
        print(
            f"the GPU is quicker from {won} cases on" if won else f"the processor is quicker up to {counts[-1]} cases"
        )


if __name__ == "__main__":
    main()
