"""math font: letters, signs and brackets that grow, for browsers on machines without such a font.

The font is a part of STIX Two Math; its license (SIL OFL 1.1) lies beside it in `fonts/`.
"""

from __future__ import annotations

import base64
from functools import cache
from pathlib import Path

# What a page that promises to load nothing has to allow its own font.
FONT_SOURCE = "font-src data:"
FAMILY = "geomtorsion math"


@cache
def font_face() -> str:
    """Style that brings the font inside the page and sets all formulas in it.

    Examples
    --------
    >>> font_face().count("@font-face"), "http" in font_face()
    (1, False)
    """
    data = Path(__file__).with_name("fonts").joinpath("stix-two-math.woff2").read_bytes()
    text = base64.b64encode(data).decode()
    return (
        f'@font-face {{ font-family: "{FAMILY}"; font-display: block; '
        f'src: url("data:font/woff2;base64,{text}") format("woff2"); }}\n'
        f'math {{ font-family: "{FAMILY}", math; }}\n'
    )
