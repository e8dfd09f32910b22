"""Importing the package has no side effects."""

import os
import subprocess
import sys
from pathlib import Path

_IMPORT_ALL = """
import os, pkgutil, sys, importlib
before = dict(os.environ)
import higvf_console
def fail(name):
    raise
for module in pkgutil.walk_packages(higvf_console.__path__, "higvf_console.", fail):
    if not module.name.endswith("__main__"):
        importlib.import_module(module.name)
changed = {name for name in before.keys() | os.environ.keys() if before.get(name) != os.environ.get(name)}
print(sorted(changed), len(sys.modules) > 0)
"""


def test_importing_every_module_writes_no_file_and_sets_no_environment_variable(tmp_path: Path) -> None:
    home, cache = tmp_path / "home", tmp_path / "cache"
    home.mkdir()
    cache.mkdir()
    environment = {**os.environ, "HOME": str(home), "XDG_CACHE_HOME": str(cache)}
    found = subprocess.run(
        [sys.executable, "-B", "-c", _IMPORT_ALL], capture_output=True, text=True, env=environment, check=False
    )
    assert (found.returncode, found.stderr) == (0, "")
    assert found.stdout.startswith("[] ")
    assert [*home.rglob("*"), *cache.rglob("*")] == []
