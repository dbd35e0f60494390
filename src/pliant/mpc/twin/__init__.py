"""The step in Python: the twin of `cpp/mpc/step`, and what runs on a compiled core that has none yet."""
