"""Settings of the documentation site; `make docs` builds it."""

import os
import sys
from importlib.metadata import version as installed
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "interfaces")]
os.environ["NUMBA_DISABLE_JIT"] = "1"  # the equations are documented as the Python functions that they are written as

project = "HI-GVF console"
copyright = "the authors of the HI-GVF console"
release = installed("higvf-console")
version = release

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "docs._ext.higvf"]
exclude_patterns = ["_build", "_data", "_ext"]
default_role = "code"  # docstrings put names in single backticks
myst_enable_extensions = ["colon_fence", "dollarmath", "deflist"]
myst_heading_anchors = 4
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True
napoleon_attr_annotations = False  # the signature has the types
napoleon_use_rtype = False  # a colon in the text of "Returns" does not end a type
# References to types and exceptions come from annotations and docstrings, and there is no network to look up those
# of other packages. All other references, documents and anchors above all, must exist.
nitpick_ignore_regex = [("py:(class|obj|data|exc)", ".*")]
suppress_warnings = ["ref.python"]  # public names have two addresses: the package's, and that of their module

html_theme = "furo"
html_title = f"HI-GVF console {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_math_renderer = "mathml"
html_show_sourcelink = False
