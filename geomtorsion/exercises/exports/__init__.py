"""exports: exercises in the formats that teachers' systems take."""

from geomtorsion.exercises.exports.writing import FORMATS, Export, export

__all__ = ["FORMATS", "Export", "export"]
