"""exports: exercises in the formats that teachers' systems import."""

from geomtorsion.teaching.exercises.exports.writing import FORMATS, Export, export

__all__ = ["FORMATS", "Export", "export"]
