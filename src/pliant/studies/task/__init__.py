"""Tasks from files, run and measured like the cases of any study."""
