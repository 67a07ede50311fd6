"""States: equations of state of cold matter, their tables and their units."""
