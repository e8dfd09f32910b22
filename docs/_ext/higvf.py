"""The project's Sphinx extension: `{generated} NAME` inserts a part of the reference that is made from the code."""

from collections.abc import Sequence
from typing import Any, ClassVar

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from docs._ext import mathml
from docs._ext.docstrings import plain_text, skip_fields
from docs._ext.tables import TABLES


class Generated(SphinxDirective):
    """A generated part; its headings become sections of the page."""

    required_arguments = 1
    has_content: ClassVar[bool] = False

    def run(self) -> Sequence[nodes.Node]:
        """The nodes of the Markdown that the table of that name gives."""
        name = self.arguments[0]
        if name not in TABLES:
            raise self.error(f"generated {name}: known parts: {', '.join(TABLES)}")
        return self.parse_text_to_nodes("\n".join(TABLES[name]()), allow_section_headings=True)


def setup(app: Sphinx) -> dict[str, Any]:
    """Adds the directive, the reading of docstrings and the drawing of equations."""
    app.add_directive("generated", Generated)
    app.connect("autodoc-process-docstring", plain_text, priority=400)
    app.connect("autodoc-skip-member", skip_fields)
    app.add_html_math_renderer("mathml", (mathml.visit_inline, None), (mathml.visit_block, None))
    return {"parallel_read_safe": True}
