"""Settings and fixtures of all tests."""

import contextlib
import gc
import io
import json
import os
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from types import SimpleNamespace
from typing import IO, Any

# As the command line does, and before NumPy starts its threads: a beam's matrices are small, and the threads of two
# processes would wait for one another.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import hypothesis
import numpy as np
import pytest

# Every run of the tests tries the same examples, and a busy machine is no error. `make fuzz` searches anew each time by
# the other profile, and keeps in .hypothesis what it finds.
STEADY: dict[str, Any] = {"deadline": None, "suppress_health_check": [hypothesis.HealthCheck.too_slow]}
hypothesis.settings.register_profile("gbeam", derandomize=True, database=None, **STEADY)
hypothesis.settings.register_profile("search", print_blob=True, **STEADY)
hypothesis.settings.load_profile("gbeam")
# Compiled programs are kept from run to run, in the project's own ignored folder.
os.environ.setdefault("JAX_COMPILATION_CACHE_DIR", str(Path(__file__).parents[1] / ".cache" / "jax"))
# Meshes that a test has reduced, others of this run read, in all of its processes; a run begins without any.
if "GBEAM_CACHE" not in os.environ:
    REDUCED = tempfile.TemporaryDirectory(prefix="gbeam-reduced-")
    os.environ["GBEAM_CACHE"] = REDUCED.name
# Files of figures take most of the time of a command; a test that is about them asks for them.
os.environ["GBEAM_FIGURES"] = "none"
# As gbeam has it, in whichever order the tests that differentiate something themselves import JAX and gbeam.
os.environ.setdefault("JAX_ENABLE_X64", "1")
# A result that is written twice is written at the same time.
os.environ["SOURCE_DATE_EPOCH"] = "1750000000"
# A test runs most programs once: compiling costs more than running. The way in which these versions fuse loops, and the
# optimization of machine code, take two thirds of it, and a program in parts for several cores a fifth of the rest; to
# later versions, which do not know the flags, they are fatal.
FLAGS = ["--xla_backend_optimization_level=0"]
if version("jaxlib").startswith(("0.8.", "0.9.", "0.10.")):
    FLAGS += ["--xla_cpu_use_fusion_emitters=false", "--xla_cpu_parallel_codegen_split_count=1"]
os.environ.setdefault("XLA_FLAGS", " ".join(FLAGS))
# Python looks for unused circles at every 700 new objects; with so many that stay, that is a twentieth of the time.
gc.set_threshold(20_000, 20, 10)

MAPS = Path("/proc/self/maps")
MOST_MAPS = 30_000  # of the 65,530 memory maps that a process may have by default


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out tests that are thorough, unless the marker or a test's own name asks for them."""
    if "thorough" in config.getoption("markexpr") or any("::" in name for name in config.args):
        return
    rare = [item for item in items if item.get_closest_marker("thorough")]
    config.hook.pytest_deselected(items=rare)
    items[:] = [item for item in items if item not in set(rare)]


def pytest_collection_finish() -> None:
    """Keep all that was imported and collected, and do not look through it again."""
    gc.collect()
    gc.freeze()


@pytest.fixture(autouse=True, scope="module")
def _release_programs() -> Iterator[None]:
    """Let go of compiled programs, each of which holds memory maps, where these run out."""
    yield
    if "jax" in sys.modules and MAPS.exists() and len(MAPS.read_bytes().splitlines()) > MOST_MAPS:
        import jax

        jax.clear_caches()
        gc.collect()


@pytest.fixture(autouse=True)
def plainly_printed() -> Iterator[None]:
    """Let NumPy print as it does by default: pyyeti changes that when it is imported."""
    with np.printoptions(legacy=False):
        yield


@pytest.fixture
def reading_in_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Read sound foreign files in this process: what is read and said comes as from a reader's own, which takes half a
    second of imports.
    """
    from gbeam.guards import processes

    def run(command: list[str], *, input: bytes, stdout: IO[bytes], **_: Any) -> subprocess.CompletedProcess[bytes]:
        *_limits, (module, name), arguments = json.loads(input)
        with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings(record=True) as said:
            warnings.resetwarnings()
            for quiet in (DeprecationWarning, PendingDeprecationWarning, ImportWarning, ResourceWarning):
                warnings.simplefilter("ignore", quiet)
            processes._send(*processes._answer(module, name, arguments), said, stdout)
        return subprocess.CompletedProcess(command, 0)

    monkeypatch.setattr(processes, "subprocess", SimpleNamespace(**vars(subprocess) | {"run": run}))
