"""What `import pliant` offers beside its parts: run, compare, and what they return."""
