"""A dynamic tree of boxes: what meets a box is found by asking those of the nodes that meet it.

Two trees share one table of nodes: the shapes that do not move, built at once and changed only when one comes, goes or
is placed anew; and those that move, in boxes with some room. A node is the box about its two children, a leaf a shape's
own. Leaves go in where boxes grow least (the surface area heuristic, in the plane the perimeter), and branches are
rotated where one has become higher than its sibling by two (AVL): Box2D's and Bullet's dynamic trees (E. Catto,
"Dynamic bounding volume hierarchies", GDC 2019). A query needs no stack: nodes know their parents.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..compile.jit import entry, kernel
from ..compile.raw_memory import record

NODE = record(
    [
        ("low_x", "f8"),  # its box (length)
        ("low_y", "f8"),
        ("high_x", "f8"),
        ("high_y", "f8"),
        ("parent", "i4"),  # -1: the root; the next in the free list
        ("left", "i4"),  # children; -1: a leaf
        ("right", "i4"),
        ("owner", "i4"),  # a leaf's shape
        ("height", "i4"),  # 0: a leaf
    ]
)

#: Places of `roots` (3,) int32: the two trees' roots, -1 for an empty tree, and the first free node.
STILL, MOVING, FREE = 0, 1, 2
#: A leaf is far from its sibling where the box about both is larger than so many times the two (in perimeter).
FAR = 1.5


@kernel(forceinline=True)
def _take(nodes: np.ndarray, roots: np.ndarray) -> int:
    i = int(roots[FREE])
    roots[FREE] = nodes[i].parent
    nodes[i].parent = -1
    nodes[i].left = -1
    nodes[i].right = -1
    nodes[i].owner = -1
    nodes[i].height = 0
    return i


@kernel(forceinline=True)
def _free(nodes: np.ndarray, roots: np.ndarray, i: int) -> None:
    nodes[i].parent = roots[FREE]
    roots[FREE] = i


@kernel(forceinline=True)
def _set_box(node: Any, low_x: float, low_y: float, high_x: float, high_y: float) -> None:
    node.low_x = low_x
    node.low_y = low_y
    node.high_x = high_x
    node.high_y = high_y


@kernel(forceinline=True)
def _fit(nodes: np.ndarray, i: int) -> None:
    """A node's box and height after its children's."""
    a = nodes[nodes[i].left]
    b = nodes[nodes[i].right]
    nodes[i].low_x = min(a.low_x, b.low_x)
    nodes[i].low_y = min(a.low_y, b.low_y)
    nodes[i].high_x = max(a.high_x, b.high_x)
    nodes[i].high_y = max(a.high_y, b.high_y)
    nodes[i].height = 1 + max(a.height, b.height)


@kernel(forceinline=True)
def _grown(node: Any, low_x: float, low_y: float, high_x: float, high_y: float) -> float:
    """Half the perimeter of a node's box with another box in it (length)."""
    return float(
        max(node.high_x, high_x) - min(node.low_x, low_x) + max(node.high_y, high_y) - min(node.low_y, low_y)
    )


@kernel(forceinline=True)
def _size(node: Any) -> float:
    return float(node.high_x - node.low_x + node.high_y - node.low_y)


@kernel(forceinline=True)
def _replace(nodes: np.ndarray, roots: np.ndarray, which: int, parent: int, old: int, new: int) -> None:
    """`new` where `old` was below `parent` (-1: as the root)."""
    nodes[new].parent = parent
    if parent < 0:
        roots[which] = new
    elif nodes[parent].left == old:
        nodes[parent].left = new
    else:
        nodes[parent].right = new


@kernel
def _rotate(nodes: np.ndarray, roots: np.ndarray, which: int, i: int, up: int) -> int:
    """The child `up` of i in the place of i, which takes over the lower of its children. Returns `up`."""
    parent = nodes[i].parent
    f = nodes[up].left
    g = nodes[up].right
    high, low = (f, g) if nodes[f].height > nodes[g].height else (g, f)
    _replace(nodes, roots, which, parent, i, up)
    if nodes[i].left == up:
        nodes[i].left = low
    else:
        nodes[i].right = low
    nodes[low].parent = i
    nodes[up].left = i
    nodes[up].right = high
    nodes[i].parent = up
    nodes[high].parent = up
    _fit(nodes, i)
    _fit(nodes, up)
    return up


@kernel
def _mend(nodes: np.ndarray, roots: np.ndarray, which: int, i: int) -> None:
    """Boxes, heights and balance from node i upwards."""
    while i >= 0:
        left = nodes[i].left
        right = nodes[i].right
        lean = nodes[right].height - nodes[left].height
        if lean > 1:
            i = _rotate(nodes, roots, which, i, right)
        elif lean < -1:
            i = _rotate(nodes, roots, which, i, left)
        else:
            _fit(nodes, i)
        i = nodes[i].parent


@kernel
def _hang(nodes: np.ndarray, roots: np.ndarray, which: int, leaf: int) -> None:
    """Put a leaf that has its box into a tree."""
    root = int(roots[which])
    if root < 0:
        nodes[leaf].parent = -1
        roots[which] = leaf
        return
    low_x, low_y = nodes[leaf].low_x, nodes[leaf].low_y
    high_x, high_y = nodes[leaf].high_x, nodes[leaf].high_y
    i = root
    while nodes[i].left >= 0:
        grown = _grown(nodes[i], low_x, low_y, high_x, high_y)
        here = 2.0 * grown  # a new node beside this one; below it, this one grows as well
        passed_on = 2.0 * (grown - _size(nodes[i]))
        a = nodes[i].left
        b = nodes[i].right
        into_a = passed_on + _grown(nodes[a], low_x, low_y, high_x, high_y)
        into_b = passed_on + _grown(nodes[b], low_x, low_y, high_x, high_y)
        if nodes[a].left >= 0:
            into_a -= _size(nodes[a])
        if nodes[b].left >= 0:
            into_b -= _size(nodes[b])
        if here < into_a and here < into_b:
            break
        i = a if into_a < into_b else b
    above = nodes[i].parent
    fork = _take(nodes, roots)
    _replace(nodes, roots, which, above, i, fork)
    nodes[fork].left = i
    nodes[fork].right = leaf
    nodes[i].parent = fork
    nodes[leaf].parent = fork
    _mend(nodes, roots, which, fork)


@kernel
def _unhang(nodes: np.ndarray, roots: np.ndarray, which: int, leaf: int) -> None:
    """Take a leaf out of its tree; the node stays its shape's."""
    fork = nodes[leaf].parent
    if fork < 0:
        roots[which] = -1
        return
    sibling = nodes[fork].right if nodes[fork].left == leaf else nodes[fork].left
    above = nodes[fork].parent
    _replace(nodes, roots, which, above, fork, sibling)
    _free(nodes, roots, fork)
    _mend(nodes, roots, which, above)


@kernel
def new_leaf(
    nodes: np.ndarray, roots: np.ndarray, owner: int, low_x: float, low_y: float, high_x: float, high_y: float
) -> int:
    """A node for a shape with that box (length), in no tree yet. There is room: two nodes a shape."""
    leaf = _take(nodes, roots)
    nodes[leaf].owner = owner
    _set_box(nodes[leaf], low_x, low_y, high_x, high_y)
    return leaf


@entry
def insert(
    nodes: np.ndarray,
    roots: np.ndarray,
    which: int,
    shape: int,
    low_x: float,
    low_y: float,
    high_x: float,
    high_y: float,
) -> int:
    """A leaf for a shape with that box (length), in tree `which`: its node."""
    leaf = new_leaf(nodes, roots, shape, low_x, low_y, high_x, high_y)
    _hang(nodes, roots, which, leaf)
    return leaf


@entry
def remove(nodes: np.ndarray, roots: np.ndarray, which: int, leaf: int) -> None:
    """The leaf is gone, its node free."""
    _unhang(nodes, roots, which, leaf)
    _free(nodes, roots, leaf)


@entry
def move(
    nodes: np.ndarray,
    roots: np.ndarray,
    which: int,
    leaf: int,
    low_x: float,
    low_y: float,
    high_x: float,
    high_y: float,
) -> None:
    """Another box (length) for a leaf. It stays where it is in the tree, as long as it is not FAR from its sibling."""
    node = nodes[leaf]
    _set_box(node, low_x, low_y, high_x, high_y)
    fork = node.parent
    if fork < 0:
        return
    sibling = nodes[nodes[fork].right if nodes[fork].left == leaf else nodes[fork].left]
    if _grown(sibling, low_x, low_y, high_x, high_y) > FAR * (_size(sibling) + _size(node)):
        _unhang(nodes, roots, which, leaf)
        _hang(nodes, roots, which, leaf)
        return
    i = int(fork)
    while i >= 0:
        here = nodes[i]
        low_x, low_y, high_x, high_y = here.low_x, here.low_y, here.high_x, here.high_y
        _fit(nodes, i)
        if here.low_x == low_x and here.low_y == low_y and here.high_x == high_x and here.high_y == high_y:
            return
        i = int(here.parent)


@kernel(forceinline=True)
def _beyond(nodes: np.ndarray, i: int, root: int) -> int:
    """The node after i and all below it, of those from `root` downwards; -1: there is none."""
    while i != root:
        parent = nodes[i].parent
        if nodes[parent].left == i:
            return int(nodes[parent].right)
        i = parent
    return -1


@entry
def next_met(
    nodes: np.ndarray, root: int, after: int, low_x: float, low_y: float, high_x: float, high_y: float
) -> int:
    """The next leaf of a tree, or of a branch, whose box meets the given one (length); -1: none.

    after: the leaf before; -1: the first.
    """
    i = root if after < 0 else _beyond(nodes, after, root)
    while i >= 0:
        node = nodes[i]
        if node.low_x > high_x or node.high_x < low_x or node.low_y > high_y or node.high_y < low_y:
            i = _beyond(nodes, i, root)
        elif node.left < 0:
            return int(i)
        else:
            i = int(node.left)
    return -1


@kernel
def next_beside(
    nodes: np.ndarray, top: int, after: int, low_x: float, low_y: float, high_x: float, high_y: float
) -> tuple[int, int]:
    """The next leaf beside another whose box meets the given one (length), and the branch from which to go on.

    Beginning with (the other leaf, -1): first what is next to it in the tree, which mostly is near. -1: none.
    """
    while True:
        fork = nodes[top].parent
        if fork < 0:
            return top, -1
        branch = nodes[fork].right if nodes[fork].left == top else nodes[fork].left
        after = next_met(nodes, branch, after, low_x, low_y, high_x, high_y)
        if after >= 0:
            return top, after
        top = fork


@kernel(forceinline=True)
def _key(nodes: np.ndarray, leaf: int, across: bool) -> float:
    node = nodes[leaf]
    return float(node.low_x + node.high_x if across else node.low_y + node.high_y)


@kernel
def _halve(nodes: np.ndarray, leaves: np.ndarray, first: int, last: int, across: bool) -> int:
    """Sort leaves[first:last] so far that none of the first half lies beyond one of the second (Hoare); the middle."""
    middle = (first + last) // 2
    low = first
    high = last - 1
    while low < high:
        pivot = _key(nodes, leaves[(low + high) // 2], across)
        i = low
        j = high
        while i <= j:
            while _key(nodes, leaves[i], across) < pivot:
                i += 1
            while _key(nodes, leaves[j], across) > pivot:
                j -= 1
            if i <= j:
                leaves[i], leaves[j] = leaves[j], leaves[i]
                i += 1
                j -= 1
        if middle <= j:
            high = j
        elif middle >= i:
            low = i
        else:
            break
    return middle


@entry
def build(nodes: np.ndarray, roots: np.ndarray, which: int, leaves: np.ndarray) -> None:
    """A tree of these leaves (n,) int32 of no tree, at once, halved along the longer side of what they take up.

    leaves: are put in another order. The tree was empty. A node that is still to be halved keeps its leaves' range in
    the place of its children, and is linked to the next such by its height.
    """
    n = len(leaves)
    if n == 0:
        return
    if n == 1:
        nodes[leaves[0]].parent = -1
        roots[which] = leaves[0]
        return
    top = _take(nodes, roots)
    nodes[top].left = 0
    nodes[top].right = n
    nodes[top].height = -1
    roots[which] = top
    pending = top
    while pending >= 0:
        i = pending
        pending = int(nodes[i].height)
        first = int(nodes[i].left)
        last = int(nodes[i].right)
        node = nodes[i]
        _set_box(node, np.inf, np.inf, -np.inf, -np.inf)
        for k in range(first, last):
            leaf = nodes[leaves[k]]
            node.low_x = min(node.low_x, leaf.low_x)
            node.low_y = min(node.low_y, leaf.low_y)
            node.high_x = max(node.high_x, leaf.high_x)
            node.high_y = max(node.high_y, leaf.high_y)
        node.height = 0
        middle = _halve(nodes, leaves, first, last, node.high_x - node.low_x > node.high_y - node.low_y)
        for side in range(2):
            start = first if side == 0 else middle
            stop = middle if side == 0 else last
            if stop - start == 1:
                child = int(leaves[start])
            else:
                child = _take(nodes, roots)
                nodes[child].left = start
                nodes[child].right = stop
                nodes[child].height = pending
                pending = child
            nodes[child].parent = i
            if side == 0:
                node.left = child
            else:
                node.right = child
    for k in range(n):
        i = int(nodes[leaves[k]].parent)
        height = 1
        while i >= 0 and nodes[i].height < height:
            nodes[i].height = height
            height += 1
            i = int(nodes[i].parent)
