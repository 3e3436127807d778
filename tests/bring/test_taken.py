"""What other programs write and hand over is taken as they have it, or refused with a word."""

from __future__ import annotations

import pytest

from rigidarea import bring

SVG11 = (
    '<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN"\n  "http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd">'
)
RECT = '<svg xmlns="http://www.w3.org/2000/svg">\n<rect width="9" height="9"/>{}</svg>'


@pytest.mark.parametrize(
    "before",
    [
        SVG11,
        f'<?xml version="1.0"?>\n<!-- <!DOCTYPE svg [ -->\n{SVG11}\n<!-- made by hand -->',
        "<!DOCTYPE svg>",
        "<!DOCTYPE svg SYSTEM 'a.dtd' >",
    ],
)
def test_a_drawing_with_a_document_type(before, tmp_path):
    """As Inkscape, Illustrator and Graphviz write it. Lines are still the file's; entities are still refused."""
    file = tmp_path / "a.svg"
    file.write_text(before + RECT.format(""))
    (outline,) = bring.outlines_from_svg(file)
    assert outline.area == 81
    file.write_text(before + RECT.format('<path d="hello"/>'))
    with pytest.raises(ValueError, match=f"line {before.count(chr(10)) + 2}, <path>"):
        bring.outlines_from_svg(file)
    for use in ("<text>&name;</text>", '<path d="M0,0h1&name;v1z"/>'):
        file.write_text(before + RECT.format(use))
        with pytest.raises(ValueError, match="undefined entity"):
            bring.outlines_from_svg(file)


@pytest.mark.parametrize(
    "before",
    [
        "<!DOCTYPE svg []>",
        '<!DOCTYPE svg [<!ENTITY name "M0,0">]>',
        SVG11[:-1] + ' [<!ENTITY name "M0,0">]>',
        '<!DOCTYPE svg [<!ENTITY % more SYSTEM "file:///etc/passwd"> %more;]>',
        "<!DOCTYPE html>",
    ],
)
def test_declarations_are_refused(before, tmp_path):
    file = tmp_path / "a.svg"
    file.write_text(before + RECT.format(""))
    with pytest.raises(ValueError, match="expected a plain drawing, got '<!DOCTYPE'"):
        bring.outlines_from_svg(file)


def test_a_long_beginning_costs_no_more_than_its_length(tmp_path):
    file = tmp_path / "a.svg"
    for part in ("<!-- -->", "<?a?>", "<!--", "<?", " ", "<!DOCTYPE svg "):
        file.write_text(part * (10**6 // len(part)) + "x")
        with pytest.raises(ValueError, match="expected"):
            bring.outlines_from_svg(file)
