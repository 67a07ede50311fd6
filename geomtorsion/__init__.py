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

from geomtorsion import errors
from geomtorsion.errors import GeomtorsionError

if TYPE_CHECKING:
    __version__: str
    # For editors and type checkers, which do not load names one by one.
    from geomtorsion import conventions, gravity, pictures, scenes, spaces
    from geomtorsion.action import (
        EquationsOfMotion,
        Linearization,
        Variation,
        conserved_quantities,
        equations_of_motion,
        linearized,
        variation,
    )
    from geomtorsion.curves import (
        Atlas,
        Chart,
        CurveProblem,
        LogMap,
        Shadow,
        TransitionMap,
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
    from geomtorsion.exact import Certainty, parse_expression
    from geomtorsion.fits import Fit, fit, fit_frame, fit_loops
    from geomtorsion.geometry import (
        Connection,
        Curvature,
        DependencyGraph,
        Form,
        Frame,
        HolonomyAlgebra,
        IdentityCheck,
        Integrability,
        LieAlgebra,
        ParallelVolume,
        Region,
        Surface,
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
        AffineMap,
        BurgersMap,
        BurgersVector,
        Cochain,
        Complex,
        Defect,
        Development,
        Diffusion,
        EdgeList,
        EnclosedDefect,
        ExactBurgersVector,
        Loop,
        Network,
        NodeRule,
        burgers_derivatives,
        burgers_map,
        burgers_vector,
        burgers_vectors,
        develop,
        develop_path,
        develop_period,
        diffusion,
        dispiration,
        enclosed_defects,
        exact_burgers_vector,
        find_defects,
        parallel_dislocations,
        parallel_edges,
        parallel_screws,
    )
    from geomtorsion.materials import crystals, images
    from geomtorsion.materials.elasticity import (
        ElasticConstants,
        NyeField,
        Stresses,
        stresses,
    )
    from geomtorsion.materials.fields import (
        SampledFrame,
        ScatteredFrame,
        defect_conservation,
        defect_densities,
    )
    from geomtorsion.materials.images import (
        LatticeBurgers,
        LatticeImage,
        LatticePhases,
    )
    from geomtorsion.materials.lines import Box, DislocationNetwork, LineArrays, Reaction
    from geomtorsion.materials.maps import (
        Circuit,
        OrientationMap,
        Phase,
    )
    from geomtorsion.ode import (
        ODE,
        At,
        EndMap,
        Engine,
        Ensemble,
        RungeKutta,
        SavedSolution,
        Solution,
        Stiff,
        Taylor,
        When,
        end_map,
        solve_many,
    )

    # mypy takes the name in the package for the module that bears it.
    from geomtorsion.ode.solve import solve
    from geomtorsion.prices import EffectBudget, PriceList, PriceRow, called_for, price
    from geomtorsion.proofs import ClosedOrbit, Crossing, Proof, closed_orbit, poincare, prove
    from geomtorsion.rigid import (
        FreeTop,
        free_top,
    )
    from geomtorsion.same import (
        CoordinateMap,
        Equivalence,
        MappedPoint,
        Symmetries,
        killing_equations,
        same_geometry,
        symmetries,
    )
    from geomtorsion.scenes import (
        Body,
        Scene,
        SceneCost,
        SceneResult,
        State,
        StateSelection,
        effects,
    )
    from geomtorsion.spaces import read_file as read
    from geomtorsion.spaces.kerr_orbits import Frequencies, KerrOrbit, kerr_orbit
    from geomtorsion.support.allowance import limits
    from geomtorsion.teaching import exercises

# Imported on first use: the import of sympy takes longer than the start of a program should.
_LATER = {
    "support.allowance": ("limits",),
    "exact": ("Certainty", "parse_expression"),
    "geometry": (
        "Connection", "Curvature", "DependencyGraph", "Form", "Frame", "HolonomyAlgebra",
        "IdentityCheck", "Integrability", "LieAlgebra", "ParallelVolume", "Region",
        "Surface", "Tensor",
        "Torsion", "blend", "cartan", "constrained", "contract", "embedded", "from_coefficients",
        "from_contortion", "from_nonmetricity", "from_spin_connection", "from_torsion",
        "identities", "levi_civita", "lie", "lie_bracket", "surface",
    ),
    "spaces": ("read",),
    "geometry.numpy_functions": ("numpy_function",),
    "action": (
        "EquationsOfMotion", "Linearization", "Variation", "conserved_quantities",
        "equations_of_motion", "linearized", "variation",
    ),
    "ode": (
        "At", "EndMap", "Ensemble", "Engine", "ODE", "RungeKutta", "SavedSolution", "Solution",
        "Stiff", "Taylor", "When", "end_map", "solve", "solve_many",
    ),
    "curves": (
        "Atlas", "Chart", "CurveProblem", "LogMap", "Shadow", "TransitionMap", "autoparallel",
        "distance_apart", "exponential_map", "geodesic", "geodesic_deviation", "holonomy",
        "log_map", "parallel_transport", "shadow", "spinning",
    ),
    "rigid": ("FreeTop", "free_top"),
    "loops": (
        "AffineMap", "BurgersMap", "BurgersVector", "Cochain", "Complex", "Defect", "Development",
        "Diffusion", "EdgeList", "EnclosedDefect", "ExactBurgersVector", "Loop", "Network",
        "NodeRule", "burgers_derivatives", "burgers_map", "burgers_vector", "burgers_vectors",
        "develop", "develop_path", "develop_period", "diffusion",
        "dispiration", "enclosed_defects", "exact_burgers_vector", "find_defects",
        "parallel_dislocations", "parallel_edges", "parallel_screws",
    ),
    "materials.elasticity": ("ElasticConstants", "NyeField", "Stresses", "stresses"),
    "materials.fields": (
        "SampledFrame", "ScatteredFrame", "defect_conservation", "defect_densities",
    ),
    "materials.lines": ("Box", "DislocationNetwork", "LineArrays", "Reaction"),
    "materials.maps": ("Circuit", "OrientationMap", "Phase"),
    "materials.images": ("LatticeBurgers", "LatticeImage", "LatticePhases"),
    "proofs": ("ClosedOrbit", "Crossing", "Proof", "closed_orbit", "poincare", "prove"),
    "same": (
        "CoordinateMap", "Equivalence", "MappedPoint", "Symmetries", "killing_equations",
        "same_geometry", "symmetries",
    ),
    "spaces.kerr_orbits": ("Frequencies", "KerrOrbit", "kerr_orbit"),
    "fits": ("Fit", "fit", "fit_frame", "fit_loops"),
    "prices": ("EffectBudget", "PriceList", "PriceRow", "called_for", "price"),
    "scenes": (
        "Body", "Scene", "SceneCost", "StateSelection", "SceneResult", "State",
        "effects",
    ),
}  # fmt: skip
# Packages that users reach by a public name, imported on first use.
_PACKAGES = {
    "conventions": "conventions", "crystals": "materials.crystals",
    "exercises": "teaching.exercises",
    "gravity": "gravity", "images": "materials.images", "pictures": "pictures", "scenes": "scenes",
    "spaces": "spaces",
}  # fmt: skip
# Names that differ from those inside the package.
_INSIDE = {"read": "read_file"}
_HOME = {name: package for package, names in _LATER.items() for name in names}

__all__ = [
    "ODE",
    "AffineMap",
    "At",
    "Atlas",
    "Body",
    "Box",
    "BurgersMap",
    "BurgersVector",
    "Certainty",
    "Chart",
    "Circuit",
    "ClosedOrbit",
    "Cochain",
    "Complex",
    "Connection",
    "CoordinateMap",
    "Crossing",
    "Curvature",
    "CurveProblem",
    "Defect",
    "DependencyGraph",
    "Development",
    "Diffusion",
    "DislocationNetwork",
    "EdgeList",
    "EffectBudget",
    "ElasticConstants",
    "EnclosedDefect",
    "EndMap",
    "Engine",
    "Ensemble",
    "EquationsOfMotion",
    "Equivalence",
    "ExactBurgersVector",
    "Fit",
    "Form",
    "Frame",
    "FreeTop",
    "Frequencies",
    "GeomtorsionError",
    "HolonomyAlgebra",
    "IdentityCheck",
    "Integrability",
    "KerrOrbit",
    "LatticeBurgers",
    "LatticeImage",
    "LatticePhases",
    "LieAlgebra",
    "LineArrays",
    "Linearization",
    "LogMap",
    "Loop",
    "MappedPoint",
    "Network",
    "NodeRule",
    "NyeField",
    "OrientationMap",
    "ParallelVolume",
    "Phase",
    "PriceList",
    "PriceRow",
    "Proof",
    "Reaction",
    "Region",
    "RungeKutta",
    "SampledFrame",
    "SavedSolution",
    "ScatteredFrame",
    "Scene",
    "SceneCost",
    "SceneResult",
    "Shadow",
    "Solution",
    "State",
    "StateSelection",
    "Stiff",
    "Stresses",
    "Surface",
    "Symmetries",
    "Taylor",
    "Tensor",
    "Torsion",
    "TransitionMap",
    "Variation",
    "When",
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
    "defect_conservation",
    "defect_densities",
    "develop",
    "develop_path",
    "develop_period",
    "diffusion",
    "dispiration",
    "distance_apart",
    "effects",
    "embedded",
    "enclosed_defects",
    "end_map",
    "equations_of_motion",
    "errors",
    "exact_burgers_vector",
    "exercises",
    "exponential_map",
    "find_defects",
    "fit",
    "fit_frame",
    "fit_loops",
    "free_top",
    "from_coefficients",
    "from_contortion",
    "from_nonmetricity",
    "from_spin_connection",
    "from_torsion",
    "geodesic",
    "geodesic_deviation",
    "gravity",
    "holonomy",
    "identities",
    "images",
    "kerr_orbit",
    "killing_equations",
    "levi_civita",
    "lie",
    "lie_bracket",
    "limits",
    "linearized",
    "log_map",
    "numpy_function",
    "parallel_dislocations",
    "parallel_edges",
    "parallel_screws",
    "parallel_transport",
    "parse_expression",
    "pictures",
    "poincare",
    "price",
    "prove",
    "read",
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
