"""Where outlines are and where they overlap: `outline` (with `arcs`, `simple`, `gate`), and the kernels that find
regions, directions, distances. The kernels are numbers alone and know no contact.
"""
