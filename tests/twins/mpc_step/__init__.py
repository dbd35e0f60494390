"""A predictive controller's step in Python: the twin of `cpp/mpc/step`."""
