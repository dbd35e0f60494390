"""The bridge to crocoddyl, and the node on any pinocchio model."""
