"""Names of the field that users type, and the line that gives each here."""

from __future__ import annotations

CURVATURE = "gt.levi_civita(frame).curvature"
LIKE = {
    "christoffel": "gt.levi_civita(frame).coefficients",
    "christoffel_symbols": "gt.levi_civita(frame).coefficients",
    "connection": "gt.cartan(frame) or gt.levi_civita(frame)",
    "weitzenboeck": "gt.cartan(frame)",
    "teleparallel": "gt.cartan(frame)",
    "metric": "frame.metric, or gt.Frame.from_metric(coordinates, metric)",
    "tetrad": "gt.Frame(coordinates, coframe)",
    "vielbein": "gt.Frame(coordinates, coframe)",
    "vierbein": "gt.Frame(coordinates, coframe)",
    "coframe": "frame.coframe",
    "space": "gt.spaces.load(name)",
    "load": "gt.spaces.load(name), or gt.read(file)",
    "list": "gt.spaces.names()",
    "torsion": "gt.cartan(frame).torsion",
    "contorsion": "gt.cartan(frame).contortion",
    "contortion": "gt.cartan(frame).contortion",
    "superpotential": "gt.cartan(frame).torsion.superpotential",
    "curvature": CURVATURE,
    "riemann": f"{CURVATURE}.riemann",
    "ricci": f"{CURVATURE}.ricci",
    "ricci_scalar": f"{CURVATURE}.scalar",
    "kretschmann": 'frame.quantity("kretschmann")',
    "weyl": 'frame.quantity("weyl")',
    "einstein": 'frame.quantity("einstein")',
    "spin_connection": "gt.cartan(frame).spin_connection",
    "killing": "gt.symmetries(frame)",
    "killing_vectors": "gt.symmetries(frame)",
    "isometries": "gt.symmetries(frame)",
    "covariant_derivative": "connection.covariant_derivative(tensor)",
    "lie_derivative": "gt.lie(vector, tensor)",
    "commutator": "gt.lie_bracket(v, w)",
    "geodesics": "gt.geodesic(frame, start, velocity)",
    "geodesic_equation": "gt.geodesic(frame, start, velocity)",
    "autoparallels": "gt.autoparallel(connection, start, velocity)",
    "burgers": "gt.burgers_vector(frame, loop)",
    "euler_lagrange": "gt.equations_of_motion(frame, lagrangian)",
    "lagrangian": "gt.gravity.Lagrangian(text, geometry)",
    "field_equations": "gt.gravity.equations(connection, lagrangian)",
    "identify": "gt.spaces.identify(frame)",
    "schwarzschild": 'gt.spaces.load("schwarzschild")',
    "kerr": 'gt.spaces.load("kerr")',
    "minkowski": 'gt.Frame("t x y z", [["1", "0", "0", "0"], ...], signature="-+++")',
    "plot": "result.plot()",
    "simplify": "tensor.simplify()",
    "tensor": "gt.Tensor(frame, slots, components)",
}


def line_of(name: str) -> str:
    """The line that gives what a name of the field means, or an empty text.

    Examples
    --------
    >>> line_of("Christoffel"), line_of("nothing")
    ('gt.levi_civita(frame).coefficients', '')
    """
    return LIKE.get(name.lower(), "")
