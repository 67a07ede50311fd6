"""OpenDiS arrays: dislocation networks as OpenDiS and ExaDiS exchange them in memory."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from geomtorsion.errors import NetworkError
from geomtorsion.materials.lines.box import Box
from geomtorsion.materials.lines.line_arrays import LineArrays
from geomtorsion.support import checks

# The required columns of each table.
NEEDED = {"cell": ("h",), "nodes": ("positions",), "segs": ("nodeids", "burgers")}


def arrays_of_opendis(data: Mapping[str, Any]) -> LineArrays:
    """Lines from the tables `cell`, `nodes` and `segs` that `export_data()` gives.

    cell: h, columns are the edges of the box, shape (3, 3); origin; is_periodic.
    nodes: positions, shape (nodes, 3); tags, shape (nodes, 2); constraints, shape (nodes, 1).
    segs: nodeids, shape (lines, 2), numbers of nodes; burgers and planes, shape (lines, 3).

    Raises
    ------
    NetworkError
        A table or an array is missing, or has another shape.

    Examples
    --------
    >>> lines = arrays_of_opendis({
    ...     "cell": {"h": [[4, 0, 0], [0, 4, 0], [0, 0, 4]]},
    ...     "nodes": {"positions": [[0, 0, 0.5], [0, 0, 3]]},
    ...     "segs": {"nodeids": [[0, 1], [1, 0]], "burgers": [[0, 0, 1], [0, 0, 1]]},
    ... })
    >>> lines.lengths.tolist(), lines.image_list
    ([1.5, 1.5], [[0, 0, -1], [0, 0, 1]])
    """
    tables: dict[str, Mapping[str, Any]] = {}
    for name, keys in NEEDED.items():
        part = data.get(name) if isinstance(data, Mapping) else None
        missing = [key for key in keys if not isinstance(part, Mapping) or part.get(key) is None]
        if missing or part is None:
            raise NetworkError(
                f"{name}: expected {', '.join(missing)}, got a table without. Give the tables "
                "cell, nodes and segs of export_data() of OpenDiS."
            )
        tables[name] = part
    cell, nodes, segs = tables["cell"], tables["nodes"], tables["segs"]
    h = checks.array(cell["h"], "h", NetworkError, shape=(3, 3))
    origin, periodic = cell.get("origin"), cell.get("is_periodic")
    box = Box(
        h.T, (0.0, 0.0, 0.0) if origin is None else origin,
        (True, True, True) if periodic is None else periodic,
    )  # fmt: skip
    tags, planes, pinned = nodes.get("tags"), segs.get("planes"), nodes.get("constraints")
    labels: list[tuple[int, ...]] = []
    if tags is not None:
        labels = [tuple(row) for row in checks.whole_array(tags, "tags", NetworkError, 2).tolist()]
        if len(set(labels)) < len(labels):
            raise NetworkError(
                "tags: expected a different tag for each node, got one tag twice. Rename a node."
            )
    if pinned is not None:
        # A column, as exported, or a row.
        pinned = checks.entries(checks.rows(pinned), "constraints", NetworkError)
        flat = [x[0] if isinstance(x, list) and len(x) == 1 else x for x in pinned]
        pinned = checks.whole_array([[x] for x in flat], "constraints", NetworkError, 1).ravel()
    return LineArrays(
        nodes["positions"], segs["nodeids"], segs["burgers"], box, None, labels, pinned, planes
    )


def opendis_of_arrays(lines: LineArrays) -> dict[str, dict[str, np.ndarray]]:
    """The tables for `import_data()` of OpenDiS.

    Raises
    ------
    NetworkError
        The network has no box.
    """
    if lines.box is None:
        raise NetworkError(
            "expected a network with a box for OpenDiS, got one without. Give one: "
            "DislocationNetwork(graph, box=...)."
        )
    tags = np.array([[0, k] for k in range(len(lines.positions))], dtype=np.int64).reshape(-1, 2)
    named = [x for x in lines.labels if isinstance(x, tuple) and len(x) == 2]
    if len(named) == len(lines.labels) and all(type(k) is int for x in named for k in x):
        tags = np.array(named, dtype=np.int64).reshape(-1, 2)
    planes = np.zeros((len(lines.pairs), 3)) if lines.planes is None else lines.planes
    return {
        "cell": {
            "h": np.array(lines.box.vectors).T,
            "origin": np.array(lines.box.origin),
            "is_periodic": np.array(lines.box.periodic),
        },
        "nodes": {
            "tags": tags,
            "positions": lines.positions.copy(),
            "constraints": np.array(lines.constraint_list, dtype=np.int64)[:, None],
        },
        "segs": {
            "nodeids": lines.pairs.copy(),
            "burgers": lines.burgers.copy(),
            "planes": planes.copy(),
        },
    }
