"""JAX as gbeam needs it: double precision, and compiled programs kept on disk from run to run.

Import this module before the first use of JAX; every numerical module does.
"""

import os

import jax
from platformdirs import user_cache_path

jax.config.update("jax_enable_x64", True)
if not os.environ.get("JAX_COMPILATION_CACHE_DIR"):
    jax.config.update("jax_compilation_cache_dir", os.fspath(user_cache_path("gbeam") / "jax"))
# By default JAX keeps only what took a second to compile: here a hundred programs take a tenth each.
if not os.environ.get("JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS"):
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.05)
