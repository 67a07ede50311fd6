"""Helix or straight line: bodies do not take the straightest path.

    python examples/12_helix_or_straight_line.py
    python examples/12_helix_or_straight_line.py --picture paths.png

On SO(3) autoparallels and geodesics are the same curves. On R^3 x SO(3), a body that rotates and
moves, the torsion force separates them: on autoparallels Omega and V are constant in the body (a
helix), on geodesics the body moves straight. The scenes `helix` and `straight_line` are these two
motions.
"""

import argparse
from pathlib import Path

import numpy as np

import geomtorsion as gt


def main(arguments: list[str] | None = None) -> None:
    """Solve both paths from the frame and as scenes, and compare them."""
    parser = argparse.ArgumentParser(description="Autoparallel and geodesic of R^3 x SO(3).")
    parser.add_argument("--picture", help="file for a picture of both paths")
    parser.add_argument("--t", type=float, default=12.0, help="final time in s")
    options = parser.parse_args(arguments)
    frame = gt.spaces.load("r3xso3").frame
    omega, velocity = [0.3, 0.2, 1.0], [1.0, 0.0, 0.2]
    # Coordinates are (phi, x); the legs of the frame are the axes of the body.
    start = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]
    speed = [*omega, *velocity]
    straight = gt.autoparallel(gt.cartan(frame), start, frame_velocity=speed)
    straightest = gt.solve(straight, options.t, accuracy=1e-11)
    short = gt.geodesic(frame, start, frame_velocity=speed)
    shortest = gt.solve(short, options.t, accuracy=1e-11)
    print(f"straightest: {straightest.engine}, error below {straightest.error:.1e}")
    print(f"shortest:    {shortest.engine}, error below {shortest.error:.1e}")

    state = gt.State(omega=omega, euler=start[:3], position=(0, 0, 0), velocity=(0, 0, 0))
    turn = gt.Scene(gt.Body(moments=(1, 1, 1)), (), state, watch=["matrix"], t=1.0).run()
    attitude = turn["matrix"].reshape(-1, 3, 3)[0]
    common = {
        "start": gt.State(
            omega=omega, euler=start[:3], position=(0, 0, 0), velocity=attitude @ velocity
        ),
        "watch": ["position"],
        "t": straightest.times,
        "accuracy": 1e-11,
    }
    body = gt.Body(mass=1, moments=(1, 1, 1))
    helix = gt.Scene(body, [gt.effects.Torsion()], **common).run()
    line = gt.Scene(body, [gt.effects.Drift()], **common).run()
    gaps = (
        np.abs(helix["position"] - straightest.coordinates[:, 3:]).max(),
        np.abs(line["position"] - shortest.coordinates[:, 3:]).max(),
    )
    print(f"as scenes they are the same to {gaps[0]:.1e} and {gaps[1]:.1e}")
    apart = np.linalg.norm(helix["position"] - line["position"], axis=1)
    print(f"at the end they are {apart[-1]:.4f} m apart")
    if options.picture:
        from geomtorsion.pictures.scene_attitude import path_picture
        from geomtorsion.pictures.style import save

        paths = {"autoparallel": helix["position"], "geodesic": line["position"]}
        save(path_picture(paths, title="one start, two paths"), Path(options.picture))
    assert max(gaps) < 1e-8
    # Known: the line is straight, the helix has the radius |V across Omega| / |Omega|.
    known = np.outer(line.times, attitude @ velocity)
    assert np.abs(line["position"] - known).max() < 1e-9
    w, v = attitude @ np.array(omega), attitude @ np.array(velocity)
    centre = np.cross(w, v) / (w @ w)
    axis = w / np.linalg.norm(w)
    out = helix["position"] - centre
    out -= np.outer(out @ axis, axis)
    radius = np.linalg.norm(v - (v @ axis) * axis) / np.linalg.norm(w)
    assert np.abs(np.linalg.norm(out, axis=1) - radius).max() < 1e-9


if __name__ == "__main__":
    main()
