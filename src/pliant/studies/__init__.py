"""Closed-loop studies: the only place that wires estimators, references, controllers and plants together."""
