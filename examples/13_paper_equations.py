"""Every equation of the paper, recomputed: the ones that agree, and the misprints.

    python examples/13_paper_equations.py
    python examples/13_paper_equations.py --misprints

Fiziev and Kleinert (1994) print 27 equations. Each statement is compared with the result of the
generic classes, computed only from the attitude of the body; `geomtorsion paper` prints the same.
"""

import argparse

from geomtorsion.paper import paper_frames, statements

MISPRINTS = {
    "(9) right", "after (9)", "(11)", "(17)", "(18)", "around (21)", "(23)", "under (24)",
    "(26)", "(27)",
}  # fmt: skip


def main(arguments: list[str] | None = None) -> None:
    """Print all statements, or the misprints with the right formula."""
    parser = argparse.ArgumentParser(description="Fiziev and Kleinert's equations, recomputed.")
    parser.add_argument("--misprints", action="store_true", help="only the misprints")
    wrong_only = parser.parse_args(arguments).misprints
    frames = paper_frames()
    print("dPhi =", frames.rotations.coframe)
    found = statements(frames)
    for statement in found:
        if not statement.agrees:
            print(f"{statement.equation}: {statement.verdict}; right is {statement.right}")
        elif not wrong_only:
            print(f"{statement.equation}: {statement.says}")

    wrong = {statement.equation for statement in found if not statement.agrees}
    assert wrong == MISPRINTS
    assert len(found) - len(wrong) == 32
    print(f"{len(found)} statements, {len(wrong)} misprints")


if __name__ == "__main__":
    main()
