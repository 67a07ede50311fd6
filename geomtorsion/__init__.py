"""Geometry, motions and Burgers vectors of any frame field (tetrad), exact where possible.

Start with `Frame` or `spaces.load`, then `cartan`, `levi_civita`, `solve`, `burgers_vector` or
`Scene`. The documentation is in examples/site of the sources; README.md explains how to build it.
Begin with the page "Your first tetrad". "How to write a tetrad file" explains spaces of your own,
and "Reference" lists every public name by topic. The page `error.page` helps with an error.
"""

# ruff: noqa: E402  # Ctrl-C ends the command quietly from here on, whatever takes long to load

from geomtorsion.cli.interrupts import begin_command

begin_command()

from difflib import get_close_matches
from importlib import import_module
from typing import TYPE_CHECKING, Any
from warnings import warn

from geomtorsion import errors
from geomtorsion.errors import GeomtorsionError
from geomtorsion.support.higher import register

register(lambda module: import_module(f"geomtorsion.{module}"))

if TYPE_CHECKING:
    __version__: str
    # For editors and type checkers, which do not load names one by one.
    from geomtorsion import (
        action,
        conventions,
        curves,
        exact,
        fits,
        geometry,
        gravity,
        loops,
        materials,
        ode,
        pictures,
        prices,
        proofs,
        rigid,
        same,
        scenes,
        spaces,
    )
    from geomtorsion.action import (
        conserved_quantities,
        equations_of_motion,
        linearized,
        variation,
    )
    from geomtorsion.curves import (
        Atlas,
        Chart,
        autoparallel,
        distance_apart,
        exponential_map,
        geodesic,
        geodesic_deviation,
        holonomy,
        log_map,
        parallel_transport,
        shadow,
        spinning,
    )
    from geomtorsion.exact import parse_expression
    from geomtorsion.fits import fit, fit_frame, fit_loops
    from geomtorsion.geometry import (
        Connection,
        Curvature,
        Form,
        Frame,
        LieAlgebra,
        Tensor,
        Torsion,
        blend,
        cartan,
        constrained,
        contract,
        embedded,
        from_coefficients,
        from_contortion,
        from_nonmetricity,
        from_spin_connection,
        from_torsion,
        identities,
        levi_civita,
        lie,
        lie_bracket,
        surface,
    )
    from geomtorsion.geometry.numpy_functions import (
        numpy_function,
    )
    from geomtorsion.loops import (
        Cochain,
        Complex,
        Loop,
        burgers_derivatives,
        burgers_map,
        burgers_vector,
        burgers_vectors,
        develop,
        develop_path,
        diffusion,
        exact_burgers_vector,
    )
    from geomtorsion.materials import crystals, images
    from geomtorsion.materials.elasticity import (
        ElasticConstants,
        NyeField,
        stresses,
    )
    from geomtorsion.materials.fields import (
        SampledFrame,
        ScatteredFrame,
    )
    from geomtorsion.materials.images import (
        LatticeImage,
    )
    from geomtorsion.materials.lines import (
        Box,
        DislocationNetwork,
        DislocationSeries,
        LineArrays,
    )
    from geomtorsion.materials.maps import (
        Circuit,
        OrientationMap,
        Phase,
    )
    from geomtorsion.ode import (
        ODE,
        At,
        RungeKutta,
        SavedSolution,
        Stiff,
        Table,
        Taylor,
        When,
        end_map,
        solve_many,
    )

    # mypy takes the name in the package for the module that bears it.
    from geomtorsion.ode.solve import solve
    from geomtorsion.prices import called_for, price
    from geomtorsion.proofs import closed_orbit, poincare, prove
    from geomtorsion.same import (
        same_geometry,
        symmetries,
    )
    from geomtorsion.scenes import (
        Body,
        Scene,
        State,
        effects,
    )
    from geomtorsion.spaces import read_file as read
    from geomtorsion.support.allowance import limits
    from geomtorsion.teaching import exercises

# Imported on first use: the import of sympy takes longer than the start of a program should.
_LATER = {
    "support.allowance": ("limits",),
    "exact": ("parse_expression",),
    "geometry": (
        "Connection", "Curvature", "Form", "Frame", "LieAlgebra", "Tensor", "Torsion", "blend",
        "cartan", "constrained", "contract", "embedded", "from_coefficients", "from_contortion",
        "from_nonmetricity", "from_spin_connection", "from_torsion", "identities", "levi_civita",
        "lie", "lie_bracket", "surface",
    ),
    "spaces": ("read",),
    "geometry.numpy_functions": ("numpy_function",),
    "action": ("conserved_quantities", "equations_of_motion", "linearized", "variation"),
    "ode": (
        "At", "ODE", "RungeKutta", "SavedSolution", "Stiff", "Table", "Taylor", "When", "end_map",
        "solve", "solve_many",
    ),
    "curves": (
        "Atlas", "Chart", "autoparallel", "distance_apart", "exponential_map", "geodesic",
        "geodesic_deviation", "holonomy", "log_map", "parallel_transport", "shadow", "spinning",
    ),
    "loops": (
        "Cochain", "Complex", "Loop", "burgers_derivatives", "burgers_map", "burgers_vector",
        "burgers_vectors", "develop", "develop_path", "diffusion", "exact_burgers_vector",
    ),
    "materials.elasticity": ("ElasticConstants", "NyeField", "stresses"),
    "materials.fields": ("SampledFrame", "ScatteredFrame"),
    "materials.lines": ("Box", "DislocationNetwork", "DislocationSeries", "LineArrays"),
    "materials.maps": ("Circuit", "OrientationMap", "Phase"),
    "materials.images": ("LatticeImage",),
    "proofs": ("closed_orbit", "poincare", "prove"),
    "same": ("same_geometry", "symmetries"),
    "fits": ("fit", "fit_frame", "fit_loops"),
    "prices": ("called_for", "price"),
    "scenes": ("Body", "Scene", "State", "effects"),
}  # fmt: skip
# Packages that users reach by a public name, imported on first use: those of special cases and of
# the classes of results are here as well.
_PACKAGES = {
    "crystals": "materials.crystals", "exercises": "teaching.exercises",
    "images": "materials.images",
} | {
    name: name
    for name in (
        "action", "conventions", "curves", "exact", "fits", "geometry", "gravity", "loops",
        "materials", "ode", "pictures", "prices", "proofs", "rigid", "same", "scenes", "spaces",
    )
}  # fmt: skip
# Names that were here until 0.3.0, by the package that has them now. They leave with 0.5.0.
_MOVED = {
    "action": ("EquationsOfMotion", "Linearization", "Variation"),
    "curves": ("CurveProblem", "LogMap", "Shadow", "TransitionMap"),
    "exact": ("Certainty",),
    "fits": ("Fit",),
    "geometry": (
        "DependencyGraph", "HolonomyAlgebra", "IdentityCheck", "Integrability",
        "ParallelVolume", "Region", "Surface",
    ),
    "loops": (
        "AffineMap", "BurgersMap", "BurgersVector", "Defect", "Development", "Diffusion",
        "EdgeList", "EnclosedDefect", "ExactBurgersVector", "Network", "NodeRule",
        "develop_period", "dispiration", "enclosed_defects", "find_defects",
        "parallel_dislocations", "parallel_edges", "parallel_screws",
    ),
    "materials.elasticity": ("Stresses",),
    "materials.fields": ("defect_conservation", "defect_densities"),
    "materials.images": ("LatticeBurgers", "LatticePhases"),
    "materials.lines": ("Reaction",),
    "ode": ("EndMap", "Engine", "Ensemble", "Solution"),
    "prices": ("EffectBudget", "PriceList", "PriceRow"),
    "proofs": ("ClosedOrbit", "Crossing", "Proof"),
    "rigid": ("FreeTop", "free_top"),
    "same": ("CoordinateMap", "Equivalence", "MappedPoint", "Symmetries", "killing_equations"),
    "scenes": ("SceneCost", "SceneResult", "StateSelection"),
    "spaces": ("Frequencies", "KerrOrbit", "kerr_orbit"),
}  # fmt: skip
# Names that differ from those inside the package.
_INSIDE = {"read": "read_file"}
_HOME = {name: package for package, names in _LATER.items() for name in names}
_NEW_HOME = {name: package for package, names in _MOVED.items() for name in names}

__all__ = [
    "ODE",
    "At",
    "Atlas",
    "Body",
    "Box",
    "Chart",
    "Circuit",
    "Cochain",
    "Complex",
    "Connection",
    "Curvature",
    "DislocationNetwork",
    "DislocationSeries",
    "ElasticConstants",
    "Form",
    "Frame",
    "GeomtorsionError",
    "LatticeImage",
    "LieAlgebra",
    "LineArrays",
    "Loop",
    "NyeField",
    "OrientationMap",
    "Phase",
    "RungeKutta",
    "SampledFrame",
    "SavedSolution",
    "ScatteredFrame",
    "Scene",
    "State",
    "Stiff",
    "Table",
    "Taylor",
    "Tensor",
    "Torsion",
    "When",
    "action",
    "autoparallel",
    "blend",
    "burgers_derivatives",
    "burgers_map",
    "burgers_vector",
    "burgers_vectors",
    "called_for",
    "cartan",
    "closed_orbit",
    "conserved_quantities",
    "constrained",
    "contract",
    "conventions",
    "crystals",
    "curves",
    "develop",
    "develop_path",
    "diffusion",
    "distance_apart",
    "effects",
    "embedded",
    "end_map",
    "equations_of_motion",
    "errors",
    "exact",
    "exact_burgers_vector",
    "exercises",
    "exponential_map",
    "fit",
    "fit_frame",
    "fit_loops",
    "fits",
    "from_coefficients",
    "from_contortion",
    "from_nonmetricity",
    "from_spin_connection",
    "from_torsion",
    "geodesic",
    "geodesic_deviation",
    "geometry",
    "gravity",
    "holonomy",
    "identities",
    "images",
    "levi_civita",
    "lie",
    "lie_bracket",
    "limits",
    "linearized",
    "log_map",
    "loops",
    "materials",
    "numpy_function",
    "ode",
    "parallel_transport",
    "parse_expression",
    "pictures",
    "poincare",
    "price",
    "prices",
    "proofs",
    "prove",
    "read",
    "rigid",
    "same",
    "same_geometry",
    "scenes",
    "shadow",
    "solve",
    "solve_many",
    "spaces",
    "spinning",
    "stresses",
    "surface",
    "symmetries",
    "variation",
]


# Checkers of types know all names from above; with this they would take any name.
if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        """A name of a higher package, imported on first use."""
        if name == "__version__":
            return _version()
        if name in _PACKAGES:
            return import_module(f"geomtorsion.{_PACKAGES[name]}")
        if name in _NEW_HOME:
            home = f"geomtorsion.{_NEW_HOME[name]}"
            text = f"geomtorsion.{name} is {home}.{name} now; the old name leaves with 0.5.0."
            warn(text, DeprecationWarning, stacklevel=2)
            return getattr(import_module(home), name)
        if name not in _HOME:
            # Read by wrong names only.
            from geomtorsion.support.field_names import line_of

            near = line_of(name) or next(iter(get_close_matches(name, __all__, n=1)), "")
            hint = f". Did you mean {near}?" if near else ""
            raise AttributeError(f"module 'geomtorsion' has no attribute {name!r}{hint}")
        found = getattr(import_module(f"geomtorsion.{_HOME[name]}"), _INSIDE.get(name, name))
        # Kept, because a second import costs as much as a short solution.
        globals()[name] = found
        return found


def _version() -> str:
    """The version, which only pyproject.toml states."""
    # Loading these takes as long as a short solution, and few users need them.
    import tomllib
    from importlib.metadata import version
    from pathlib import Path

    # In a checkout its own file counts, even if an older version is installed.
    file = Path(__file__).parents[1] / "pyproject.toml"
    if file.exists():
        project = tomllib.loads(file.read_text("utf-8")).get("project", {})
        if project.get("name") == "geomtorsion":
            return project["version"]
    return version("geomtorsion")


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__, "__version__"]
