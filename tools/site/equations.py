"""Hook of the site: turns equations into MathML at build time, so that the pages need no script."""

import html
import re

from math_core import LatexError, LatexToMathML
from mkdocs.exceptions import PluginError

INLINE = re.compile(r'<span class="arithmatex">\\\((.*?)\\\)</span>', re.S)
DISPLAYED = re.compile(r'<div class="arithmatex">\\\[(.*?)\\\]</div>', re.S)


def on_page_content(content: str, page: object, **_: object) -> str:
    """Return a page with its equations as MathML.

    Raises:
        PluginError: if an equation cannot be parsed.
    """
    converter = LatexToMathML()

    def mathml(found: re.Match[str]) -> str:
        equation = html.unescape(found[1]).strip()
        try:
            made = converter.convert_with_local_state(equation, displaystyle=found.re is DISPLAYED)
        except LatexError as error:
            raise PluginError(f"{page}: {equation}: {error}") from error
        # A wide equation scrolls by itself; otherwise the whole page would scroll on a phone.
        return f'<div class="equation">{made}</div>' if found.re is DISPLAYED else made

    return INLINE.sub(mathml, DISPLAYED.sub(mathml, content))
