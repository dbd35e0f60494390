"""The chain of estimators in Python: the twin of `cpp/estimation`."""
