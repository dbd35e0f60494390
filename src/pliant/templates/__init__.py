"""Files that `pliant new` writes: they are whole, and checked like the rest."""
