"""Stars: equations of state by pieces or tables, and the stars that are made of them."""
