"""Numeric: frames whose components are numbers, power series or values on a grid."""
